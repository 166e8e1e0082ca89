// Dequantise: the entries of a slice that comes in whole numbers, as a stream has it.
// Reads planes of opacity and colour, two bytes a number; writes 8·(n_max+1)² + 4 bytes per entry. One thread per leaf,
// then one per node. Bound by memory: 14·(n_max+1)² + 18 bytes per leaf, whose entries are scattered.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/dequantise.h"

layout(local_size_x = kSliceGroup) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
READ_ARRAY(uint, kDequantisePlanes, planes);
READ_ARRAY(uint, kDequantiseEntries, entry_of_leaf);
READ_ARRAY(uvec2, kDequantisePositions, leaf_positions);
READ_ARRAY(uvec2, kDequantiseNodes, node_entries);
READ_ARRAY(float, kDequantiseTables, tables);
WRITE_ARRAY(uvec2, kDequantiseOut, entries);
WRITE_ARRAY(uint, kDequantiseLeaves, entry_leaf);
layout(push_constant) uniform Push { DequantisePush push; };

int number_of(uint plane, uint leaf) {
    const uint word = FETCH(planes, int(plane * push.plane_words + leaf / 2u)).x;
    return int((leaf & 1u) == 0u ? word << 16u : word) >> 16;
}

// R, G and B of a harmonic, in units: rgb_of of quantised_slice.h.
vec3 units_of(uint harmonic, uint leaf) {
    const uint plane = 1u + 3u * harmonic;
    const float y = float(number_of(plane, leaf)), co = float(number_of(plane + 1u, leaf)),
                cg = float(number_of(plane + 2u, leaf));
    const float t = y - 0.5 * cg, b = t - 0.5 * co;
    return vec3(b + co, cg + t, b);
}

vec3 from_table(uint first, uvec3 index) {
    return vec3(FETCH(tables, int(first + index.r)).x, FETCH(tables, int(first + index.g)).x,
                FETCH(tables, int(first + index.b)).x);
}

void store_words(uint entry, uint harmonic, float sigma, vec3 k) {
    const uvec2 words = uvec2(packHalf2x16(vec2(sigma, k.r)), packHalf2x16(k.gb));
    STORE(entries, int(entry * sh_count(kHhDegree) + harmonic), uvec4(words, 0u, 0u));
}

void store_leaf(uint leaf) {
    const uint entry = FETCH(entry_of_leaf, int(leaf)).x;
    if (entry == kNoLeaf) return;
    const uint depth = (FETCH(leaf_positions, int(leaf)).y >> 16u) - push.levels_above;
    const uint sigma = kTableSigma + depth * kOpacityCount + uint(number_of(0u, leaf));
    const uvec3 mean = uvec3(clamp(ivec3(2.0 * units_of(0u, leaf)), 0, int(kMeanCount) - 1));
    store_words(entry, 0u, FETCH(tables, int(sigma)).x, from_table(0u, mean));
    for (uint l = 1u, harmonic = 1u; l <= kHhDegree; ++l) {
        const vec3 per_unit = from_table(kTablePerUnit + l * kMeanCount, mean);
        for (uint m = 0u; m <= 2u * l; ++m, ++harmonic)
            store_words(entry, harmonic, 0.0, per_unit * units_of(harmonic, leaf));
    }
    STORE(entry_leaf, int(entry), uvec4(leaf));
}

void store_node(uint i) {
    const uvec2 node = FETCH(node_entries, int(i)).xy;
    const int first = int(node.x * sh_count(kHhDegree));
    STORE(entries, first, uvec4(kEntryIsNode, node.y, 0u, 0u));
    for (uint j = 1u; j < sh_count(kHhDegree); ++j) STORE(entries, first + int(j), uvec4(0u));
    STORE(entry_leaf, int(node.x), uvec4(kNoLeaf));
}

void main() {
    const uint i = gl_GlobalInvocationID.x;
    if (i < push.leaves)
        store_leaf(i);
    else if (i < push.leaves + push.nodes)
        store_node(i - push.leaves);
}
