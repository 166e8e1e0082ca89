// Slice, first half: σ(t) of every leaf; leaves with σ > 0 get a slot.
// Reads w^σ (⌈C/4⌉ texels per leaf); writes per leaf its head (σ in 1/m, slot), per slot its leaf, per node the mask of
// live cells, and the live count, which has the group counts of passes that run over slots. One thread per
// kLeavesPerThread leaves, so that the cost of the workgroup's barriers and its one atomic addition is shared by many
// leaves. Bound by memory: 16·⌈C/4⌉ + 8 bytes per leaf.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/slice.h"

layout(local_size_x = kSliceGroup) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
layout(constant_id = 1) const uint kBasisPlanes = 8u;
layout(constant_id = 2) const uint kBusyPlanes = 8u;
layout(constant_id = 3) const bool kHalfWeights = false;
layout(constant_id = 4) const bool kWeightsByAddress = false;
READ_ARRAY(any4, kSliceWeights, leaf_weights);
layout(binding = kSliceRows, std140) uniform Rows { BasisRows rows; };
WRITE_ARRAY(uvec2, kSliceHead, head);
WRITE_ARRAY(uint, kSliceLeaves, slot_leaf);
layout(binding = kSliceLive, std430) buffer Live { LiveCount live; };
READ_ARRAY(uvec2, kSliceLeafCells, leaf_cells);
layout(binding = kSliceNodeLive, std430) buffer NodeLive { uint node_live[]; };
layout(push_constant) uniform Push { SlicePush push; };
#include "slice/weights.glsl"

shared uint group_count;
shared uint group_first;

void store_leaf(uint leaf, float sigma, uint slot) {
    const bool overflows = sigma > 0.0 && slot >= push.capacity;
    if (overflows) atomicAdd(live.overflow, 1u);
    STORE(head, int(leaf), uvec4(overflows ? 0u : floatBitsToUint(sigma), slot, 0u, 0u));
    if (!(sigma > 0.0) || overflows) return;
    STORE(slot_leaf, int(slot), uvec4(leaf));
    const uvec2 cells = FETCH(leaf_cells, int(leaf)).xy;
    atomicOr(node_live[cells.x], cells.y);
}

void main() {
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    const uint first_leaf = push.first_leaf + (group * kSliceGroup + gl_LocalInvocationID.x) * kLeavesPerThread;
    if (gl_LocalInvocationID.x == 0u) group_count = 0u;
    barrier();

    vec4 sigma;
    uint live_leaves = 0u;
    for (uint i = 0u; i < kLeavesPerThread; ++i) {
        const uint leaf = first_leaf + i;
        sigma[i] = leaf < push.end_leaf ? leaf_sigma(leaf, push.leaf_count) : 0.0;
        live_leaves += sigma[i] > 0.0 ? 1u : 0u;
    }
    const uint offset = live_leaves > 0u ? atomicAdd(group_count, live_leaves) : 0u;
    barrier();
    if (gl_LocalInvocationID.x == 0u && group_count > 0u) {
        group_first = atomicAdd(live.slots, group_count);
        const uint end = min(group_first + group_count, push.capacity);
        atomicMax(live.groups_x, (end + kSliceGroup - 1u) / kSliceGroup);
    }
    barrier();

    uint slot = group_first + offset;
    for (uint i = 0u; i < kLeavesPerThread; ++i) {
        const uint leaf = first_leaf + i;
        if (leaf < push.end_leaf) store_leaf(leaf, sigma[i], slot);
        if (sigma[i] > 0.0) ++slot;
    }
}
