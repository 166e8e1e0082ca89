// Set: opaque pieces; the depth test comes before shading. Reads the material's textures, lights and shadow maps;
// writes linear premultiplied light and metres along the camera's axis. One invocation per texel and triangle. Bound by
// fetches (set_surface.glsl).
#version 460
#extension GL_GOOGLE_include_directive : require
#include "set/set_surface.glsl"

layout(location = 0) out vec4 light;
layout(location = 1) out float metres;

void main() {
    const SetMaterial material = fetch_material(push.material);
    light = shade_fragment(material, base_colour(material));
    metres = 1.0 / gl_FragCoord.w;  // clip w is the distance along the axis
}
