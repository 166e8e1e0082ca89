#include "voctree/sh_weights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace neuvv::voctree {

namespace {

// C^a_k(x), the Gegenbauer polynomials, for k ≤ 3.
double gegenbauer(uint32_t k, double a, double x) {
    double before = 0, value = 1;
    for (uint32_t i = 1; i <= k; ++i) {
        const double next = (2 * x * (i + a - 1) * value - (i + 2 * a - 2) * before) / i;
        before = value;
        value = next;
    }
    return value;
}

double factorial(uint32_t n) {
    return n <= 1 ? 1 : n * factorial(n - 1);
}

// A_nl = 2^l l! √(2(n+1)(n−l)! / (π (n+l+1)!)).
double normalisation(uint32_t n, uint32_t l) {
    return std::exp2(l) * factorial(l) *
           std::sqrt(2 * (n + 1) * factorial(n - l) / (std::numbers::pi * factorial(n + l + 1)));
}

}  // namespace

Radial radial_functions(double gamma) {
    static const auto kFactors = [] {
        Radial factors{};
        for (uint32_t n = 0; n <= kMaxHhDegree; ++n)
            for (uint32_t l = 0; l <= n; ++l) factors[n][l] = static_cast<float>(normalisation(n, l));
        return factors;
    }();
    const double sine = std::sin(gamma), cosine = std::cos(gamma);
    Radial radial{};
    for (uint32_t n = 0; n <= kMaxHhDegree; ++n)
        for (uint32_t l = 0; l <= n; ++l)
            radial[n][l] =
                static_cast<float>(double{kFactors[n][l]} * std::pow(sine, l) * gegenbauer(n - l, l + 1.0, cosine));
    return radial;
}

std::array<double, kMaxShCount> sh_basis(glm::dvec3 d) {
    return {0.28209479177387814,
            0.4886025119029199 * d.y,
            0.4886025119029199 * d.z,
            0.4886025119029199 * d.x,
            1.0925484305920792 * d.x * d.y,
            1.0925484305920792 * d.y * d.z,
            0.31539156525252005 * (3 * d.z * d.z - 1),
            1.0925484305920792 * d.x * d.z,
            0.5462742152960396 * (d.x * d.x - d.y * d.y),
            0.5900435899266435 * d.y * (3 * d.x * d.x - d.y * d.y),
            2.890611442640554 * d.x * d.y * d.z,
            0.4570457994644658 * d.y * (5 * d.z * d.z - 1),
            0.3731763325901154 * d.z * (5 * d.z * d.z - 3),
            0.4570457994644658 * d.x * (5 * d.z * d.z - 1),
            1.445305721320277 * d.z * (d.x * d.x - d.y * d.y),
            0.5900435899266435 * d.x * (d.x * d.x - 3 * d.y * d.y)};
}

const std::array<ShDirection, 26>& sh_directions() {
    static const auto kDirections = [] {
        std::array<ShDirection, 26> directions;
        size_t count = 0;
        for (int i = 0; i < 27; ++i) {
            const glm::dvec3 cell(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
            const double squared = glm::dot(cell, cell);  // 1: along an axis, 2: to an edge, 3: to a corner of the cube
            if (squared == 0) continue;
            directions[count++] = {cell / std::sqrt(squared), 4 * std::numbers::pi *
                                                                  (squared == 1   ? 1.0 / 21
                                                                   : squared == 2 ? 4.0 / 105
                                                                                  : 9.0 / 280)};
        }
        return directions;
    }();
    return kDirections;
}

void make_still(VOctree& tree, uint32_t degree) {
    tree.bases = 1;
    tree.frames = 1;
    tree.hh_degree = degree;
    tree.sigma_basis = {1};
    tree.gamma_basis = {0};
}

void write_sh(float* weights, uint32_t degree, const float* k) {
    static const std::array<float, kMaxHhDegree + 1> kRadial = [] {  // R_ll(π/2)
        std::array<float, kMaxHhDegree + 1> radial{};
        for (uint32_t l = 0; l < radial.size(); ++l) radial[l] = static_cast<float>(normalisation(l, l));
        return radial;
    }();
    std::fill_n(weights, hh_count(degree), 0.0f);
    for (uint32_t l = 0; l <= degree; ++l) {
        const uint32_t first = l * (l + 1) * (2 * l + 1) / 6 + l * l;  // H_l,l,−l
        for (uint32_t i = 0; i <= 2 * l; ++i) weights[first + i] = k[l * l + i] / kRadial[l];
    }
}

}  // namespace neuvv::voctree
