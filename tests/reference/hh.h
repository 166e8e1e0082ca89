// The hyperspherical-harmonic (HH) basis in double precision, in the paper's two forms.
//
//   H_nlm(d, γ) = R_nl(γ) Y_lm(d),  R_nl(γ) = A_nl sin^l γ C^{l+1}_{n-l}(cos γ)          (errata 1, 2, 7)
//
// Directions: the paper's (x2, x3, x4) / sin γ are the world's (z, x, y), so θ is measured from +Z and φ from +X to +Y.
// Real SH have no Condon-Shortley phase; m > 0 are the cosine terms, m < 0 the sine terms. The order of functions is
// defined in shaders/shared/hh_counts.h.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "shared/hh_counts.h"

namespace neuvv::reference {

uint32_t hh_index(int n, int l, int m);
uint32_t sh_index(int l, int m);

// Angular form: Gegenbauer and Legendre recurrences on γ, θ, φ.
double gegenbauer(int degree, double alpha, double x);
double radial(int n, int l, double gamma);
double radial_slope(int n, int l, double gamma);  // dR_nl/dγ
double real_sh(int l, int m, double theta, double phi);
std::vector<double> sh_basis(uint32_t degree, glm::dvec3 direction);
std::vector<double> hh_basis(uint32_t degree, double gamma, glm::dvec3 direction);

// The Cartesian form of the appendix: polynomials in a unit vector of four dimensions, by explicit sums. It shares no
// code with the angular form, so that each checks the other.
std::vector<double> hh_basis_cartesian(uint32_t degree, const glm::dvec4& x);

// (x1..x4) of the appendix for a hyper angle and a unit world direction.
glm::dvec4 hypersphere_point(double gamma, glm::dvec3 direction);

}  // namespace neuvv::reference
