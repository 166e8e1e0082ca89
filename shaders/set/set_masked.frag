// Set: masked pieces, as set.frag, but fragments below the material's alpha cutoff are discarded. It is a separate
// shader, because a shader that may discard is run before the depth test.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "set/set_surface.glsl"

layout(location = 0) out vec4 light;
layout(location = 1) out float metres;

void main() {
    const SetMaterial material = fetch_material(push.material);
    const vec4 base = base_colour(material);
    if (base.a < material.alpha.x) discard;
    light = shade_fragment(material, base);
    metres = 1.0 / gl_FragCoord.w;
}
