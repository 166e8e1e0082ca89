// Slice, first half: σ(t) of every leaf; leaves with σ > 0 get a slot.
// Reads w^σ (⌈C/4⌉ texels a leaf); writes head (σ 1/m, slot) a leaf, leaf a slot, and the live count with the group count of
// the passes that run over slots. One thread per leaf. Bound by memory: 16·⌈C/4⌉ + 8 bytes a leaf.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/slice.h"

layout(local_size_x = kSliceGroup) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
layout(constant_id = 1) const uint kBasisPlanes = 8u;
layout(constant_id = 2) const uint kBusyPlanes = 8u;
layout(binding = kSliceWeights) uniform textureBuffer leaf_weights;
layout(binding = kSliceRows, std140) uniform Rows { BasisRows rows; };
layout(binding = kSliceHead, rg32ui) writeonly uniform uimageBuffer head;
layout(binding = kSliceLeaves, r32ui) writeonly uniform uimageBuffer slot_leaf;
layout(binding = kSliceLive, std430) buffer Live { LiveCount live; };
layout(push_constant) uniform Push { SlicePush push; };
#include "weights.glsl"

shared uint group_count;
shared uint group_first;

void main() {
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    const uint leaf = group * kSliceGroup + gl_LocalInvocationID.x;
    const bool inside = leaf < push.leaf_count;
    if (gl_LocalInvocationID.x == 0u) group_count = 0u;
    barrier();

    float sigma = inside ? leaf_sigma(leaf, push.leaf_count) : 0.0;
    const uint place = sigma > 0.0 ? atomicAdd(group_count, 1u) : 0u;
    barrier();
    if (gl_LocalInvocationID.x == 0u && group_count > 0u) {
        group_first = atomicAdd(live.slots, group_count);
        const uint end = min(group_first + group_count, push.capacity);
        atomicMax(live.groups_x, (end + kSliceGroup - 1u) / kSliceGroup);
    }
    barrier();

    const uint slot = group_first + place;
    if (sigma > 0.0 && slot >= push.capacity) {
        atomicAdd(live.overflow, 1u);
        sigma = 0.0;
    }
    if (!inside) return;
    imageStore(head, int(leaf), uvec4(floatBitsToUint(sigma), slot, 0u, 0u));
    if (sigma > 0.0) imageStore(slot_leaf, int(slot), uvec4(leaf));
}
