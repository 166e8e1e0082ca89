// Slice tree, second half: the entry of every live leaf, with its σ and SH coefficients.
// Reads the leaf's σ, w^γ and w^HH; writes 8·(n_max+1)² + 4 bytes per entry. One thread per slot of the live leaves,
// dispatched indirectly. Bound by memory: 8·(⌈C/4⌉ + N_HH + (n_max+1)²) bytes per live leaf.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/slice_tree.h"

layout(local_size_x = kSliceGroup) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
layout(constant_id = 1) const uint kBasisPlanes = 8u;
layout(constant_id = 2) const uint kBusyPlanes = 8u;
layout(constant_id = 3) const bool kHalfWeights = false;
layout(constant_id = 4) const bool kWeightsByAddress = false;
READ_ARRAY(any4, kSliceWeights, leaf_weights);
layout(binding = kSliceRows, std140) uniform Rows { BasisRows rows; };
READ_ARRAY(uvec2, kSliceHead, head);
READ_ARRAY(uint, kSliceLeaves, slot_leaf);
layout(binding = kSliceLive, std430) readonly buffer Live { LiveCount live; };
READ_ARRAY(uvec2, kEntriesCells, leaf_cells);
READ_ARRAY(uvec4, kEntriesNodes, nodes);
WRITE_ARRAY(uvec2, kEntriesOut, entries);
WRITE_ARRAY(uint, kEntriesLeaves, entry_leaf);
layout(push_constant) uniform Push { SliceEntriesPush push; };
#include "trace/node.glsl"

float sigma;

void store_coefficient(uint entry, uint j, vec3 k) {
    const vec3 in_range = clamp(k, -kMaxEntryNumber, kMaxEntryNumber);
    const uvec2 words = uvec2(packHalf2x16(vec2(j == 0u ? min(sigma, kMaxEntryNumber) : 0.0, in_range.r)),
                              packHalf2x16(in_range.gb));
    STORE(entries, int(entry * sh_count(kHhDegree) + j), uvec4(words, 0u, 0u));
}
#include "slice/slice_leaf.glsl"

void main() {
    const uint slot = push.first_slot + gl_GlobalInvocationID.x;
    if (slot >= min(live.slots, push.capacity)) return;
    const uint leaf = FETCH(slot_leaf, int(slot)).x;
    const uvec2 cells = FETCH(leaf_cells, int(leaf)).xy;
    const uvec4 words = FETCH(nodes, int(push.node_base + (cells.x >> 1u)));
    const Node node = make_node(words.xy, words.xy, words.z, words.w);
    const uint bit = 32u * (cells.x & 1u) + uint(findLSB(cells.y));
    if (!node_lives(node, bit)) return;  // there was no room for the node's entries
    const uint entry = node_child(node, bit);
    sigma = uintBitsToFloat(FETCH(head, int(leaf)).x);
    STORE(entry_leaf, int(entry), uvec4(leaf));
    store_leaf_colour(entry, leaf, push.leaf_count);
}
