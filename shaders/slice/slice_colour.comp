// Slice, second half: the SH coefficients of every live leaf.
// Reads w^γ and w^HH of the slot's leaf; writes (n_max+1)² texels (R, G, B) per slot. One thread per slot, dispatched
// indirectly. Bound by memory: 16·(⌈C/4⌉ + N_HH + (n_max+1)²) bytes per live leaf.
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
READ_ARRAY(uint, kSliceLeaves, slot_leaf);
layout(binding = kSliceLive, std430) readonly buffer Live { LiveCount live; };
WRITE_ARRAY(vec4, kSliceSh, slice_sh);
layout(push_constant) uniform Push { SlicePush push; };
#include "slice/slice_leaf.glsl"

void store_coefficient(uint slot, uint j, vec3 k) {
    STORE(slice_sh, int(slot * sh_count(kHhDegree) + j), vec4(k, 0.0));
}

void main() {
    const uint slot = gl_GlobalInvocationID.x;
    if (slot >= min(live.slots, push.capacity)) return;
    store_leaf_colour(slot, FETCH(slot_leaf, int(slot)).x, push.leaf_count);
}
