// Highlight: tints the shaded entries of an instance red, each by its bone. Their luminance stays visible as a lighter
// or darker red. Colours of PlenOctrees, which are sRGB here, become a little darker than others.
// Reads the bones of entries; reads and writes shaded entries whose bone is tinted. One thread per entry, dispatched
// indirectly for each view. Bound by memory: 1 byte per entry, and 16 per tinted one.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/highlight.h"
#include "shared/slice_tree.h"

layout(local_size_x = kSliceGroup) in;
READ_ARRAY(uint, kHighlightBones, entry_bones);
UPDATE_ARRAY(uvec2, kHighlightShaded, shaded);
layout(binding = kBindCount, std430) readonly buffer Count { LiveCount counts[]; };
layout(push_constant) uniform Push { HighlightPush push; };

vec3 tinted(vec3 colour, float tint) {
    const float light = 0.4 + 0.6 * dot(colour, vec3(0.2126, 0.7152, 0.0722));
    return mix(colour, light * vec3(1.0, 0.05, 0.03), kHighlightShare * tint);
}

void main() {
    const uint entry = gl_GlobalInvocationID.x;
    if (entry >= min(counts[push.slice].slots, push.capacity)) return;
    const uint four_bones = FETCH(entry_bones, int(push.slice * push.bone_words + (entry >> 2u))).x;
    const uint bone = four_bones >> 8u * (entry & 3u) & 255u;
    const float tint = bone == kNoBone ? 0.0 : float(push.tints[bone >> 2u] >> 8u * (bone & 3u) & 255u) / 255.0;
    if (tint == 0.0) return;
    const int at = int(push.view * push.capacity + entry);
    const uvec2 words = LOAD(shaded, at).xy;
    const vec3 colour = tinted(vec3(unpackHalf2x16(words.x).y, unpackHalf2x16(words.y)), tint);
    STORE(shaded, at, uvec4((words.x & 0xffffu) | packHalf2x16(vec2(0.0, colour.r)), packHalf2x16(colour.gb), 0u, 0u));
}
