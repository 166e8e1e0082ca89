// Set: blended pieces, drawn far to near. What lies behind the volume of its texel goes over the opaque set, what lies
// before it into a layer of its own. Reads as set.frag and the volume's depth (metres along the axis, infinity without);
// writes linear premultiplied light, 0 into the other layer, which leaves that as it is.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "set_surface.glsl"

layout(binding = kSetVolumeDepth) uniform textureBuffer volume_depth;
layout(location = 0) out vec4 behind;
layout(location = 1) out vec4 front;

void main() {
    const SetMaterial material = fetch_material(push.material);
    const vec4 light = shade_fragment(material, base_colour(material));
    const uvec2 texel = uvec2(gl_FragCoord.xy);
    const float volume = texelFetch(volume_depth, int(push.first_texel + texel.y * push.width + texel.x)).x;
    const bool before = 1.0 / gl_FragCoord.w < volume && !isinf(volume);
    behind = before ? vec4(0.0) : light;
    front = before ? light : vec4(0.0);
}
