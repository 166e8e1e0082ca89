#include "reference/composite.h"

#include <cmath>

namespace neuvv::reference {
namespace {

// The number of samples before the ray ends.
size_t samples_taken(const std::vector<Sample>& samples, double stop_transmittance) {
    double transmittance = 1;
    for (size_t i = 0; i < samples.size(); ++i) {
        transmittance *= std::exp(-samples[i].sigma * samples[i].delta_m);
        if (transmittance < stop_transmittance) return i + 1;
    }
    return samples.size();
}

}  // namespace

RayResult composite(const std::vector<Sample>& samples, double stop_transmittance) {
    const size_t count = samples_taken(samples, stop_transmittance);
    RayResult result;
    double transmittance = 1;
    double weighted_depth = 0;
    for (size_t i = 0; i < count; ++i) {
        const Sample& sample = samples[i];
        const double alpha = -std::expm1(-sample.sigma * sample.delta_m);
        result.colour += transmittance * alpha * sample.colour;
        weighted_depth += transmittance * alpha * sample.z_m;
        transmittance *= 1 - alpha;
    }
    result.alpha = 1 - transmittance;
    if (result.alpha > 0) result.depth_m = weighted_depth / result.alpha;
    return result;
}

std::vector<SampleGradient> composite_adjoint(const std::vector<Sample>& samples, glm::dvec3 d_colour, double d_alpha,
                                              double stop_transmittance) {
    const size_t count = samples_taken(samples, stop_transmittance);
    std::vector<double> transmittance(count + 1, 1.0);
    for (size_t i = 0; i < count; ++i) {
        transmittance[i + 1] = transmittance[i] * std::exp(-samples[i].sigma * samples[i].delta_m);
    }
    // From C = Σ_i (T_i − T_{i+1}) c_i and ∂T_j/∂σ_i = −δ_i T_j for j > i:
    //   ∂C/∂σ_i = δ_i (T_{i+1} c_i − Σ_{j>i} T_j α_j c_j),  ∂α̂/∂σ_i = δ_i T_end,  ∂C/∂c_i = T_i α_i.
    std::vector<SampleGradient> gradient(samples.size());
    glm::dvec3 behind{0};  // Σ_{j>i} T_j α_j c_j
    for (size_t i = count; i-- > 0;) {
        const Sample& sample = samples[i];
        const double weight = transmittance[i] - transmittance[i + 1];
        gradient[i].colour = weight * d_colour;
        const glm::dvec3 colour_slope = transmittance[i + 1] * sample.colour - behind;
        gradient[i].sigma = sample.delta_m * (glm::dot(d_colour, colour_slope) + d_alpha * transmittance[count]);
        behind += weight * sample.colour;
    }
    return gradient;
}

}  // namespace neuvv::reference
