// Sample: the colour of a leaf along a direction of view, linear RGB (errata 8), and the adjoint.
#pragma once

#include <glm/glm.hpp>

#include "reference/slice.h"

namespace neuvv::reference {

// c = sigmoid(Σ_lm k_lm Y_lm(d)), d the ray's unit direction.
glm::dvec3 sample_colour(const LeafSlice& slice, uint32_t degree, glm::dvec3 direction);

// The same from all HH weights without the split into slice and sample: sigmoid(Σ_nlm w_nlm H_nlm(d, γ)).
glm::dvec3 sample_colour_direct(const LeafWeights& weights, double gamma, uint32_t degree, glm::dvec3 direction);

// The loss's derivative by k, given its derivative by the colour.
ShCoefficients sample_colour_adjoint(const LeafSlice& slice, uint32_t degree, glm::dvec3 direction,
                                     glm::dvec3 d_colour);

}  // namespace neuvv::reference
