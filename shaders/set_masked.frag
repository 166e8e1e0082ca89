// Set: masked pieces, as set.frag; fragments below the material's alpha cutoff leave nothing. A shader of its own, since
// what may discard is shaded before its depth is known to count.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "set_surface.glsl"

layout(location = 0) out vec4 light;
layout(location = 1) out float metres;

void main() {
    const SetMaterial material = fetch_material(push.material);
    const vec4 base = base_colour(material);
    if (base.a < material.alpha.x) discard;
    light = shade_fragment(material, base);
    metres = 1.0 / gl_FragCoord.w;
}
