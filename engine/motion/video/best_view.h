// From where errors are seen best.
#pragma once

#include <glm/glm.hpp>
#include <span>

namespace neuvv::motion {

struct WeightedError {
    glm::dvec3 error{0};  // from where a joint is to where it should be, metres
    double weight = 1;
};

// What is visible of the errors along a unit direction of view: Σ w (|e|² − (v·e)²).
double visible_error(std::span<const WeightedError> errors, const glm::dvec3& view);

// The unit direction of view, its sign free, along which the most is visible: the eigenvector of M = Σ w e eᵀ with the
// least eigenvalue. Where several directions show alike (all errors on one line), the most horizontal one of them. +Z
// where there are no errors.
glm::dvec3 best_view_direction(std::span<const WeightedError> errors);

// The same among level directions (y = 0).
glm::dvec3 best_level_view(std::span<const WeightedError> errors);

}  // namespace neuvv::motion
