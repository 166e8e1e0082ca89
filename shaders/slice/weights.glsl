// Accessors of a leaf's weights, and σ, γ and SH coefficients computed from them. The includer declares the array
// `leaf_weights`, binds uniform block member `rows` (BasisRows), and has kHhDegree, kBasisPlanes and kBusyPlanes as
// specialisation constants, and for storage buffers kHalfWeights, whether the weights are fp16, and kWeightsByAddress.
// With the latter, `leaf_weights` is not read: they are longer than what a device binds or allocates at once, so `rows`
// has the addresses of their parts. They are fp16 then.
#ifndef NEUVV_WEIGHTS_GLSL
#define NEUVV_WEIGHTS_GLSL
#include "arrays.glsl"
#include "slice/hh.glsl"

#ifndef NEUVV_FETCH_WEIGHTS
#ifdef NEUVV_STORAGE_BUFFERS
layout(buffer_reference, std430, buffer_reference_align = 8) readonly buffer WeightPart { half4 weights[]; };

vec4 fetch_by_address(uint leaf, uint plane, uint leaf_count) {
    const uint number = plane >> rows.part_planes_log2;
    const uvec4 pair = rows.weights[number >> 1u];
    WeightPart part = WeightPart((number & 1u) == 0u ? pair.xy : pair.zw);
    return element(part.weights[(plane - (number << rows.part_planes_log2)) * leaf_count + leaf]);
}
#endif

vec4 fetch_weights(uint leaf, uint plane, uint leaf_count) {
#ifdef NEUVV_STORAGE_BUFFERS
    if (kWeightsByAddress) return fetch_by_address(leaf, plane, leaf_count);
    const uint at = plane * leaf_count + leaf;
    if (!kHalfWeights) return uintBitsToFloat(uvec4(leaf_weights[2u * at].words, leaf_weights[2u * at + 1u].words));
#endif
    return FETCH(leaf_weights, int(plane * leaf_count + leaf));
}
#endif

// σ = relu(A_t·w^σ), 1/m (errata 9)
float leaf_sigma(uint leaf, uint leaf_count) {
    float raw = 0.0;
    for (uint i = 0u; i < kBusyPlanes; ++i)
        raw += dot(rows.sigma[i], fetch_weights(leaf, rows.planes[i].x, leaf_count));
    return max(raw, 0.0);
}

// γ = π·sigmoid(B_t·w^γ) (errata 9)
float leaf_gamma(uint leaf, uint leaf_count) {
    float raw = 0.0;
    for (uint i = 0u; i < kBusyPlanes; ++i)
        raw += dot(rows.gamma[i], fetch_weights(leaf, kBasisPlanes + rows.planes[i].y, leaf_count));
    return kPi / (1.0 + exp(-raw));
}

vec3 leaf_hh(uint leaf, uint function, uint leaf_count) {
    return fetch_weights(leaf, 2u * kBasisPlanes + function, leaf_count).rgb;
}

// k_lm = Σ_n w_nlm R_nl(γ) at SH index j of degree l, given the row of R with that l (errata 7).
vec3 slice_coefficient(uint leaf, uint j, vec4 radial, uint l, uint leaf_count) {
    vec3 k = vec3(0.0);
    for (uint n = l; n <= kHhDegree; ++n) k += radial[n] * leaf_hh(leaf, kHhBase[n] + j, leaf_count);
    return k;
}

#endif
