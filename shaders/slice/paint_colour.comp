// Paint on a slice, second half: the colours, in the entries of the slice tree (paint.glsl).
// Reads edits and the nodes of their leaves; reads and writes (n_max+1)² texels of an entry. One thread per painted
// leaf. Bound by memory: 20 bytes per edit, 16·(n_max+1)² + 32 per leaf whose colour changes.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/paint.h"
#include "shared/slice_tree.h"

layout(local_size_x = kSliceGroup) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
layout(constant_id = 1) const bool kSrgbColours = false;  // the entries'; paint is linear light
READ_ARRAY(uvec2, kPaintLeaves, painted_leaves);
READ_ARRAY(uvec4, kPaintEdits, edits);
READ_ARRAY(uint, kPaintSigmas, edit_sigmas);
layout(binding = kPaintLayers) uniform utextureBuffer layers;
READ_ARRAY(uvec2, kPaintCells, leaf_cells);
READ_ARRAY(uvec4, kPaintNodes, nodes);
UPDATE_ARRAY(uvec2, kPaintEntries, entries);
layout(push_constant) uniform Push { PaintPush push; };
#include "trace/node.glsl"
#include "slice/paint.glsl"
#include "slice/paint_edits.glsl"
#include "srgb.glsl"

// Finds the first texel of the leaf's entry; false where the leaf is not live.
bool entry_of(uint leaf, out int first) {
    const uvec2 cells = FETCH(leaf_cells, int(leaf)).xy;
    const uvec4 words = FETCH(nodes, int(push.node_base + (cells.x >> 1u)));
    const Node node = make_node(words.xy, words.xy, words.z, words.w);
    const uint bit = 32u * (cells.x & 1u) + uint(findLSB(cells.y));
    first = int(node_child(node, bit) * sh_count(kHhDegree));
    return node_lives(node, bit);
}

vec3 coefficient(uvec2 words) { return vec3(unpackHalf2x16(words.x).y, unpackHalf2x16(words.y)); }

void store_coefficient(int at, uint low_word, vec3 k) {
    const vec3 in_range = clamp(k, -kMaxEntryNumber, kMaxEntryNumber);
    const uint red = packHalf2x16(vec2(0.0, in_range.r)) | (low_word & 0xffffu);
    STORE(entries, at, uvec4(red, packHalf2x16(in_range.gb), 0u, 0u));
}

void main() {
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    const uint at = group * kSliceGroup + gl_LocalInvocationID.x;
    if (at >= push.leaves) return;
    const uvec2 painted = FETCH(painted_leaves, int(at)).xy;  // the leaf, its first edit
    const uint end = FETCH(painted_leaves, int(at + 1u)).y;
    int first;
    if (!entry_of(painted.x, first)) return;
    const uvec2 mean = LOAD(entries, first).xy;
    Painted leaf = Painted(1.0 / (1.0 + exp(-kShConstant * coefficient(mean))), 1.0, 0.0);
    if (kSrgbColours) leaf.colour = srgb_decode(leaf.colour);
    bool changed = false;
    for (uint i = painted.y; i < end; ++i) {
        Edit edit;
        if (!edit_applies(i, edit) || edit.alpha * edit.opacity == 0.0) continue;
        paint_over(leaf, edit.blend, edit.alpha * edit.opacity, edit.target);
        changed = true;
    }
    if (!changed) return;
    if (kSrgbColours) leaf.colour = srgb_encode(leaf.colour);
    store_coefficient(first, mean.x, painted_mean(leaf));
    for (int j = 1; j < int(sh_count(kHhDegree)); ++j)
        store_coefficient(first + j, 0u, painted_coefficient(leaf, coefficient(LOAD(entries, first + j).xy)));
}
