// Spherical harmonics as weights of a leaf, for trees of one frame (hh.glsl has the functions of all others).
#pragma once

#include <array>

#include "voctree/voctree.h"

namespace neuvv::voctree {

// R_nl(γ), by n and l ≤ n (errata 1, 2).
using Radial = std::array<std::array<float, kMaxHhDegree + 1>, kMaxHhDegree + 1>;
Radial radial_functions(double gamma);

// Y_lm(d) of a unit direction without the Condon-Shortley phase, index l² + l + m (sh.glsl), all degrees.
std::array<double, kMaxShCount> sh_basis(glm::dvec3 d);

// A direction of a quadrature over the sphere.
struct ShDirection {
    glm::dvec3 d;
    double weight;  // all sum to 4π
};
// The 26 directions from the centre of a cube to its faces, edges and corners. Exact for polynomials of degree 7
// (Lebedev).
const std::array<ShDirection, 26>& sh_directions();

// Makes a tree one of a single frame and basis, at which γ is π/2 where w^γ is 0. Changes no leaves.
void make_still(VOctree& tree, uint32_t degree);

// Writes the w^HH of a channel, hh_count(degree) numbers, whose slice at γ = π/2 is k_lm, sh_count(degree) numbers. The
// functions with n > l get 0.
void write_sh(float* weights, uint32_t degree, const float* k);

}  // namespace neuvv::voctree
