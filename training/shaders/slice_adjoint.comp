// The adjoint of slice, and the optimiser: the gradients of a slot's σ and SH move the weights of its leaf.
//   ∂w^σ = ∂σ A_t,  ∂w_nlm = R_nl(γ) ∂k_lm,  ∂γ = Σ w_nlm R'_nl(γ)·∂k_lm,  ∂w^γ = ∂γ π s(1−s) B_t   (errata 7, 9)
// It also clears the gradients for the next step, records the use of each leaf, and updates the slice to the moved
// weights, so that a next step at this frame need not slice again. With kLearnRows it also writes each workgroup's sums
// of ∂A_t and ∂B_t. One thread per touched slot, dispatched indirectly. Bound by memory: weights and two moments are
// read and written, 96 bytes for each plane with a gradient.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/training.h"

layout(local_size_x = kSliceGroup) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
layout(constant_id = 1) const uint kBasisPlanes = 8u;
layout(constant_id = 2) const uint kLearnRows = 0u;
layout(constant_id = 3) const uint kBusyPlanes = 8u;
UPDATE_ARRAY(vec4, kAdjointWeights, weights);
UPDATE_ARRAY(vec4, kAdjointFirstMoments, first);
UPDATE_ARRAY(vec4, kAdjointSecondMoments, second);
layout(binding = kAdjointRows, std140) uniform Rows { BasisRows rows; };
READ_ARRAY(uint, kAdjointLeaves, slot_leaf);
READ_ARRAY(uint, kAdjointTouched, touched_slots);
layout(binding = kAdjointCount, std430) readonly buffer Count { LiveCount count; };
layout(binding = kAdjointGradients, std430) buffer Gradients { float gradients[]; };
layout(binding = kAdjointMaxWeight, std430) buffer MaxWeight { uint max_weight[]; };
UPDATE_ARRAY(vec2, kAdjointLeafUse, leaf_use);
UPDATE_ARRAY(uint, kAdjointLeafFrames, leaf_frames);
READ_ARRAY(uvec2, kAdjointPositions, leaf_positions);
layout(binding = kAdjointPartials, std430) writeonly buffer Partials { vec4 partials[]; };
WRITE_ARRAY(uvec2, kAdjointHead, head);
WRITE_ARRAY(vec4, kAdjointSh, slice_sh);
layout(push_constant) uniform Push { SliceAdjointPush push; };

vec4 fetch_weights(uint leaf, uint plane, uint leaf_count) { return LOAD(weights, int(plane * leaf_count + leaf)); }
#define NEUVV_FETCH_WEIGHTS
#include "adam.glsl"
#include "slice/slice_leaf.glsl"

void store_coefficient(uint slot, uint j, vec3 k) {
    STORE(slice_sh, int(slot * sh_count(kHhDegree) + j), vec4(k, 0.0));
}

shared vec4 share[kSliceGroup];

void move_plane(uint leaf, uint plane, vec4 gradient, float rate) {
    if (gradient == vec4(0.0) && push.adam.emit == 0u) return;
    const int texel = int(plane * push.leaf_count + leaf);
    const AdamElement old = AdamElement(LOAD(weights, texel), LOAD(first, texel), LOAD(second, texel));
    const AdamElement new = adam_update(old, gradient, rate, push.adam);
    STORE(weights, texel, new.weight);
    STORE(first, texel, new.first);
    STORE(second, texel, new.second);
}

// Where each frame has its own basis: keeps w^σ of the slice's frame from falling to where no gradient reaches it.
void keep_dense(uint leaf, float least_sigma) {
    for (uint i = 0u; i < kBusyPlanes; ++i) {
        const int texel = int(rows.planes[i].x * push.leaf_count + leaf);
        const vec4 weight = LOAD(weights, texel);
        const bvec4 of_frame = greaterThan(rows.sigma[i], vec4(0.0));
        STORE(weights, texel, mix(weight, max(weight, vec4(least_sigma)), of_frame));
    }
}

// Sums one plane of the rows' gradient over the threads of the workgroup.
void sum_partial(uint plane, vec4 value) {
    const uint lane = gl_LocalInvocationID.x;
    share[lane] = value;
    barrier();
    if (lane == 0u) {
        vec4 sum = vec4(0.0);
        for (uint i = 0u; i < kSliceGroup; ++i) sum += share[i];
        partials[gl_WorkGroupID.x * (2u * kMaxBasisPlanes) + plane] = sum;
    }
    barrier();
}

// The workgroup's sums of ∂A_t and ∂B_t, from weights that this step has not moved yet.
void sum_rows(bool inside, uint leaf, float d_sigma, float d_raw_gamma) {
    for (uint p = 0u; p < kBasisPlanes; ++p) {
        sum_partial(p, inside ? d_sigma * fetch_weights(leaf, p, push.leaf_count) : vec4(0.0));
        sum_partial(kMaxBasisPlanes + p,
                    inside ? d_raw_gamma * fetch_weights(leaf, kBasisPlanes + p, push.leaf_count) : vec4(0.0));
    }
}

vec3 take_gradient(uint at) {
    return vec3(gradients[at], gradients[at + 1u], gradients[at + 2u]);
}

// Moves the HH weights of one l in every n, and returns what these functions contribute to ∂L/∂γ.
float band_adjoint(uint leaf, uint base, uint l, vec4 radial, vec4 radial_adjoint, float rate) {
    float d_gamma = 0.0;
    for (uint n = l; n <= kHhDegree; ++n)
        for (uint j = l * l; j < (l + 1u) * (l + 1u); ++j) {
            const vec3 d_k = take_gradient(base + 2u + 3u * j);
            const uint function = kHhBase[n] + j;
            d_gamma += radial_adjoint[n] * dot(leaf_hh(leaf, function, push.leaf_count), d_k);
            move_plane(leaf, 2u * kBasisPlanes + function, vec4(radial[n] * d_k, 0.0), rate);
        }
    return d_gamma;
}

// Moves the HH weights; returns ∂L/∂(B_t·w^γ).
float colour_adjoint(uint leaf, uint base) {
    const float gamma = leaf_gamma(leaf, push.leaf_count);
    const HhRadial r = hh_radial(gamma), d = hh_radial_adjoint(gamma);
    float d_gamma = band_adjoint(leaf, base, 0u, r.l0, d.l0, push.colour_rate);
    if (kHhDegree >= 1u) d_gamma += band_adjoint(leaf, base, 1u, r.l1, d.l1, push.detail_rate);
    if (kHhDegree >= 2u) d_gamma += band_adjoint(leaf, base, 2u, r.l2, d.l2, push.detail_rate);
    if (kHhDegree >= 3u) d_gamma += band_adjoint(leaf, base, 3u, r.l3, d.l3, push.detail_rate);
    return d_gamma * gamma * (1.0 - gamma / kPi);
}

void note_frame(uint leaf, uint frame, bool used) {
    const int word = int((frame / 32u) * push.leaf_count + leaf);
    const uint bit = used ? 1u << (frame % 32u) : 0u;
    STORE(leaf_frames, word, uvec4(LOAD(leaf_frames, word).x | bit));
}

// Records how rays used a leaf (LeafUse), for growth.
void note_use(uint leaf, float weight, float opacity_sensitivity) {
    const vec2 before = LOAD(leaf_use, int(leaf)).xy;
    STORE(leaf_use, int(leaf), vec4(max(before.x, weight), before.y + opacity_sensitivity, 0.0, 0.0));
    note_frame(leaf, push.frame, weight >= push.min_used_weight);
    note_frame(leaf, push.frame_after, weight >= push.min_used_weight);
}

void main() {
    uint leaf = 0u, slot = kNoSlot;
    if (gl_GlobalInvocationID.x < count.slots) slot = FETCH(touched_slots, int(gl_GlobalInvocationID.x)).x;
    const bool inside = slot != kNoSlot;
    float d_sigma = 0.0, d_raw_gamma = 0.0;
    if (inside) {
        const uint base = slot * gradient_stride(kHhDegree);
        leaf = FETCH(slot_leaf, int(slot)).x;
        note_use(leaf, uintBitsToFloat(max_weight[slot]), gradients[base + 1u]);
        max_weight[slot] = 0u;
        d_sigma = gradients[base];
        d_raw_gamma = colour_adjoint(leaf, base);
        for (uint i = 0u; i < gradient_stride(kHhDegree); ++i) gradients[base + i] = 0.0;
    }
    if (kLearnRows != 0u) sum_rows(inside, leaf, d_sigma, d_raw_gamma);
    if (!inside) return;
    const uint depth = FETCH(leaf_positions, int(leaf)).y >> 16u;
    const float sigma_rate = push.sigma_rate * float(1u << depth) / push.box_size;
    for (uint i = 0u; i < kBusyPlanes; ++i) {
        move_plane(leaf, rows.planes[i].x, d_sigma * rows.sigma[i], sigma_rate);
        move_plane(leaf, kBasisPlanes + rows.planes[i].y, d_raw_gamma * rows.gamma[i], push.gamma_rate);
    }
    if (push.least_depth > 0.0) keep_dense(leaf, push.least_depth * float(1u << depth) / push.box_size);
    STORE(head, int(leaf), uvec4(floatBitsToUint(leaf_sigma(leaf, push.leaf_count)), slot, 0u, 0u));
    store_leaf_colour(slot, leaf, push.leaf_count);
}
