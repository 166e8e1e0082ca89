// Set: blended pieces, drawn from far to near. A fragment behind the volume at its texel is blended over the opaque
// set, a fragment before the volume into a separate layer. Reads what set.frag reads, and the volume's depth (metres
// along the axis, infinity where there is none). Writes linear premultiplied light to one layer and 0 to the other,
// which blending then does not change.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "set/set_surface.glsl"

READ_ARRAY(float, kSetVolumeDepth, volume_depth);
layout(location = 0) out vec4 behind;
layout(location = 1) out vec4 front;

void main() {
    const SetMaterial material = fetch_material(push.material);
    const vec4 light = shade_fragment(material, base_colour(material));
    const uvec2 texel = uvec2(gl_FragCoord.xy);
    const float volume = FETCH(volume_depth, int(push.first_texel + texel.y * push.width + texel.x)).x;
    const bool before = 1.0 / gl_FragCoord.w < volume && !isinf(volume);
    behind = before ? vec4(0.0) : light;
    front = before ? light : vec4(0.0);
}
