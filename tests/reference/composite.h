// Composite: from the samples of one ray, near to far, to premultiplied colour, alpha and depth (the volume rendering
// equation; errata 10, 12), and the adjoint.
#pragma once

#include <glm/glm.hpp>
#include <limits>
#include <vector>

namespace neuvv::reference {

struct Sample {
    double sigma = 0;      // 1/m
    glm::dvec3 colour{0};  // linear, not premultiplied
    double delta_m = 0;    // length of the interval
    double z_m = 0;        // distance along the ray to the interval's centre
};

struct RayResult {
    glm::dvec3 colour{0};                                      // premultiplied linear
    double alpha = 0;                                          // 1 − the transmittance behind the last sample used
    double depth_m = std::numeric_limits<double>::infinity();  // infinite where alpha is 0
};

// Sample i adds T_i α_i c_i with α_i = 1 − exp(−σ_i δ_i). The ray ends after the sample behind which the transmittance
// is below stop_transmittance; with 0 all samples are used.
RayResult composite(const std::vector<Sample>& samples, double stop_transmittance = 0);

struct SampleGradient {
    double sigma = 0;
    glm::dvec3 colour{0};
};
// The loss's derivatives by each sample, given those by the ray's colour and alpha; no gradient flows through the
// depth. Samples behind the stop get 0.
std::vector<SampleGradient> composite_adjoint(const std::vector<Sample>& samples, glm::dvec3 d_colour, double d_alpha,
                                              double stop_transmittance = 0);

}  // namespace neuvv::reference
