#include "reference/sample.h"

#include <cmath>

#include "reference/hh.h"

namespace neuvv::reference {

glm::dvec3 sample_colour(const LeafSlice& slice, uint32_t degree, glm::dvec3 direction) {
    const std::vector<double> basis = sh_basis(degree, direction);
    glm::dvec3 colour;
    for (int channel = 0; channel < 3; ++channel) {
        double sum = 0;
        for (size_t i = 0; i < basis.size(); ++i) sum += slice.k[static_cast<size_t>(channel)][i] * basis[i];
        colour[channel] = sigmoid(sum);
    }
    return colour;
}

glm::dvec3 sample_colour_direct(const LeafWeights& weights, double gamma, uint32_t degree, glm::dvec3 direction) {
    const std::vector<double> basis = hh_basis(degree, gamma, direction);
    glm::dvec3 colour;
    for (int channel = 0; channel < 3; ++channel) {
        double sum = 0;
        for (size_t i = 0; i < basis.size(); ++i) sum += weights.hh[static_cast<size_t>(channel)][i] * basis[i];
        colour[channel] = sigmoid(sum);
    }
    return colour;
}

ShCoefficients sample_colour_adjoint(const LeafSlice& slice, uint32_t degree, glm::dvec3 direction,
                                     glm::dvec3 d_colour) {
    const std::vector<double> basis = sh_basis(degree, direction);
    const glm::dvec3 colour = sample_colour(slice, degree, direction);
    const glm::dvec3 d_sum = d_colour * colour * (1.0 - colour);
    ShCoefficients d_k{};
    for (int channel = 0; channel < 3; ++channel) {
        for (size_t i = 0; i < basis.size(); ++i) d_k[static_cast<size_t>(channel)][i] = d_sum[channel] * basis[i];
    }
    return d_k;
}

}  // namespace neuvv::reference
