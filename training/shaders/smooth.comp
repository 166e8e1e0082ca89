// The smoothness loss and its derivative in one pass: how much the opacity of a leaf that rays touched differs from
// those of the leaves at its six faces (total variation of α, as in Plenoxels; Fridovich-Keil and Yu et al. 2022).
//   L_i = λ Σ_n √((α_i − α_n)² + ε²),  α = 1 − e^(−σ edge_i)
// Neighbours count as constants, as each touched leaf has a term of its own. An empty neighbour has α_n = 0; of finer
// neighbours, the leaf at the centre of the face counts. Adds ∂L_i/∂σ_i to the slot's gradient. One thread per touched
// slot, dispatched indirectly. Bound by the dependent fetches of six descents into the tree.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/training.h"

layout(local_size_x = kSliceGroup) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
layout(constant_id = 1) const uint kNodeLevels = 4u;
layout(constant_id = 2) const uint kTopLevels = 2u;
READ_ARRAY(uint, kTraceLinks, tree_links);
READ_ARRAY(uvec4, kTraceNodes, tree_nodes);
READ_ARRAY(uint, kSmoothLeaves, slot_leaf);
READ_ARRAY(uvec2, kSmoothPositions, leaf_positions);
READ_ARRAY(uint, kSmoothTouched, touched_slots);
layout(binding = kSmoothCount, std430) readonly buffer Count { LiveCount count; };
layout(binding = kSmoothGradients, std430) buffer Gradients { float gradients[]; };
layout(push_constant) uniform Push { SmoothPush push; };
#include "trace/slice_sample.glsl"

const float kEpsilon = 0.1;  // ε; differences of α below it count by their squares

// α, over the length `edge`, of the live leaf at a finest cell; 0 where there is none.
float alpha_at(ivec3 cell, float edge) {
    March walk;
    walk.mirror = ivec3(0);
    walk.mirror_bit = 0u;
    walk.cell = cell;
    walk.t = 0.0;
    walk.t_end = 1.0;
    if (!march_enter(walk)) return 0.0;
    const uint bit = march_bit(walk);
    if (!node_lives(walk.node, bit) || !march_wants(march_child(node_child(walk.node, bit)) & ~kLeafBit)) return 0.0;
    return 1.0 - exp(-sigma * edge);
}

// Σ_n ∂√(…)/∂α_i over the six faces of the leaf. `low`, `size`: its corner and edge in finest cells.
float sum_of_faces(float alpha, float edge, ivec3 low, int size) {
    float d_alpha = 0.0;
    for (int axis = 0; axis < 3; ++axis)
        for (int face = 0; face < 2; ++face) {
            ivec3 cell = low + size / 2;
            cell[axis] = face == 0 ? low[axis] - 1 : low[axis] + size;
            const float d = alpha - alpha_at(cell, edge);
            d_alpha += d * inversesqrt(d * d + kEpsilon * kEpsilon);
        }
    return d_alpha;
}

void main() {
    if (gl_GlobalInvocationID.x >= count.slots) return;
    const uint own_slot = FETCH(touched_slots, int(gl_GlobalInvocationID.x)).x;
    if (own_slot == kNoSlot) return;
    const uint leaf = FETCH(slot_leaf, int(own_slot)).x;
    const uvec2 position = FETCH(leaf_positions, int(leaf)).xy;
    const uint depth = position.y >> 16u, shift = 2u * kNodeLevels - depth;
    const float edge = push.box_size / float(1u << depth);
    const float clear = exp(-uintBitsToFloat(FETCH(head, int(leaf)).x) * edge);
    const ivec3 low = ivec3(position.x & 0xffffu, position.x >> 16u, position.y & 0xffffu) << int(shift);
    gradients[own_slot * gradient_stride(kHhDegree)] +=
        push.weights.smoothness * push.pixel_share *
        sum_of_faces(1.0 - clear, edge, low, 1 << int(shift)) * edge * clear;
}
