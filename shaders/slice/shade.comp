// Shade: evaluates the SH of every live leaf once for an eye, in the direction from the eye to the leaf's centre
// instead of along each ray, so that a sample needs only one fetch.
// Reads entries of a slice tree and their leaves; writes one shaded entry each. One thread per entry, dispatched
// indirectly. Bound by memory: 8·(n_max+1)² + 20 bytes per entry.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/slice_tree.h"

layout(local_size_x = kSliceGroup) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
READ_ARRAY(uvec2, kShadeEntries, entries);
READ_ARRAY(uint, kShadeLeaves, entry_leaf);
READ_ARRAY(uvec2, kShadePositions, leaf_positions);
layout(binding = kShadeCount, std430) readonly buffer Count { LiveCount counts[]; };
WRITE_ARRAY(uvec2, kShadeOut, shaded);
layout(push_constant) uniform Push { ShadePush push; };
#include "slice/leaf_centre.glsl"
#include "slice/sh.glsl"

// The unit direction, in the performer's space, from the eye to the centre of a leaf.
vec3 direction_of(uvec2 position) {
    const vec3 line = leaf_centre(position, push.box_min.xyz, push.box_size.xyz) - push.eye.xyz;
    return line * inversesqrt(max(dot(line, line), 1e-20));
}

void main() {
    if (gl_GlobalInvocationID.x >= min(counts[push.slice].slots, push.capacity)) return;
    const uint entry = push.slice * push.capacity + gl_GlobalInvocationID.x;
    const int first = int(entry * sh_count(kHhDegree));
    const uvec2 words = FETCH(entries, first).xy;
    const uint leaf = FETCH(entry_leaf, int(entry)).x;
    const float sh_y[kMaxShCount] = sh_basis(direction_of(FETCH(leaf_positions, int(leaf == kNoLeaf ? 0u : leaf)).xy));
    vec3 raw = sh_y[0] * vec3(unpackHalf2x16(words.x).y, unpackHalf2x16(words.y));
    for (uint j = 1u; j < sh_count(kHhDegree); ++j) {
        const uvec2 more = FETCH(entries, first + int(j)).xy;
        raw += sh_y[j] * vec3(unpackHalf2x16(more.x).y, unpackHalf2x16(more.y));
    }
    const vec3 colour = 1.0 / (1.0 + exp(-raw));  // errata 8
    const uvec2 leaf_words = uvec2((words.x & 0xffffu) | packHalf2x16(vec2(0.0, colour.r)), packHalf2x16(colour.gb));
    const int to = int(push.view * push.capacity + gl_GlobalInvocationID.x);
    STORE(shaded, to, uvec4(leaf == kNoLeaf ? words : leaf_words, 0u, 0u));
}
