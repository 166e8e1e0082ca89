// The paper's backward pass: at every sample, every weight of its leaf gets its derivative, without a slice. It is the
// reference for the speed and correctness of trace_adjoint.glsl and slice_adjoint.comp together. It reads what
// direct.comp reads and adds to `gradients`, which is laid out as the weights. One workgroup per tile, one thread per
// ray. It is bound by its atomic additions: per sample 8 for each busy plane, and 3·N_HH.
#include "adjoint_bindings.glsl"

layout(constant_id = 3) const uint kBasisPlanes = 8u;
layout(constant_id = 4) const uint kBusyPlanes = 8u;
const bool kHalfWeights = false, kWeightsByAddress = false;
READ_ARRAY(any4, kTraceWeights, leaf_weights);
layout(binding = kTraceRows, std140) uniform Rows { BasisRows rows; };
#include "trace/direct_sample.glsl"
#include "ray_adjoint.glsl"

// The index of the first of the four gradients that the leaf has in a plane.
uint plane_at(uint plane) { return 4u * (plane * push.leaf_count + at_leaf); }

void add_plane(uint plane, vec4 gradient) {
    for (uint i = 0u; i < 4u; ++i) gradient_add(plane_at(plane) + i, gradient[i]);
}

// Adds the derivatives by w_nlm for one l; returns what these functions contribute to ∂L/∂γ.
float scatter_band(uint l, vec4 radial, vec4 radial_adjoint, vec3 d_raw) {
    float d_gamma = 0.0;
    for (uint n = l; n <= kHhDegree; ++n)
        for (uint j = l * l; j < (l + 1u) * (l + 1u); ++j) {
            const uint function = kHhBase[n] + j;
            const vec3 d_k = sh_y[j] * d_raw;
            d_gamma += radial_adjoint[n] * dot(leaf_hh(at_leaf, function, push.leaf_count), d_k);
            const uint at = plane_at(2u * kBasisPlanes + function);
            for (uint channel = 0u; channel < 3u; ++channel) gradient_add(at + channel, radial[n] * d_k[channel]);
        }
    return d_gamma;
}

void scatter(float weight, float d_sigma, float opacity_sensitivity, vec3 d_raw) {
    const float gamma = leaf_gamma(at_leaf, push.leaf_count);
    const HhRadial r = hh_radial(gamma), d = hh_radial_adjoint(gamma);
    float d_gamma = scatter_band(0u, r.l0, d.l0, d_raw);
    if (kHhDegree >= 1u) d_gamma += scatter_band(1u, r.l1, d.l1, d_raw);
    if (kHhDegree >= 2u) d_gamma += scatter_band(2u, r.l2, d.l2, d_raw);
    if (kHhDegree >= 3u) d_gamma += scatter_band(3u, r.l3, d.l3, d_raw);
    const float d_raw_gamma = d_gamma * gamma * (1.0 - gamma / kPi);
    for (uint i = 0u; i < kBusyPlanes; ++i) {
        add_plane(rows.planes[i].x, d_sigma * rows.sigma[i]);
        add_plane(kBasisPlanes + rows.planes[i].y, d_raw_gamma * rows.gamma[i]);
    }
}
