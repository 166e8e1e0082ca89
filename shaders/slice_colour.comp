// Slice, second half: the SH coefficients of every live leaf.
// Reads w^γ and w^HH of the slot's leaf; writes (n_max+1)² texels (R, G, B) a slot. One thread per slot, dispatched
// indirectly. Bound by memory: 16·(⌈C/4⌉ + N_HH + (n_max+1)²) bytes a live leaf.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/slice.h"

layout(local_size_x = kSliceGroup) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
layout(constant_id = 1) const uint kBasisPlanes = 8u;
layout(constant_id = 2) const uint kBusyPlanes = 8u;
layout(binding = kSliceWeights) uniform textureBuffer leaf_weights;
layout(binding = kSliceRows, std140) uniform Rows { BasisRows rows; };
layout(binding = kSliceLeaves) uniform utextureBuffer slot_leaf;
layout(binding = kSliceLive, std430) readonly buffer Live { LiveCount live; };
layout(binding = kSliceSh, rgba32f) writeonly uniform imageBuffer slice_sh;
layout(push_constant) uniform Push { SlicePush push; };
#include "weights.glsl"

void store_band(uint slot, uint leaf, uint l, vec4 radial) {
    for (uint j = l * l; j < (l + 1u) * (l + 1u); j++) {
        const vec3 k = slice_coefficient(leaf, j, radial, l, push.leaf_count);
        imageStore(slice_sh, int(slot * sh_count(kHhDegree) + j), vec4(k, 0.0));
    }
}

void main() {
    const uint slot = gl_GlobalInvocationID.x;
    if (slot >= min(live.slots, push.capacity)) return;
    const uint leaf = texelFetch(slot_leaf, int(slot)).x;
    const HhRadial radial = hh_radial(leaf_gamma(leaf, push.leaf_count));
    store_band(slot, leaf, 0u, radial.l0);
    if (kHhDegree >= 1u) store_band(slot, leaf, 1u, radial.l1);
    if (kHhDegree >= 2u) store_band(slot, leaf, 2u, radial.l2);
    if (kHhDegree >= 3u) store_band(slot, leaf, 3u, radial.l3);
}
