#include "reference/hh.h"

#include <cmath>
#include <cstdlib>
#include <numbers>

namespace neuvv::reference {
namespace {

double factorial(int n) {
    return n <= 1 ? 1.0 : n * factorial(n - 1);
}

double binomial(int n, int k) {
    return k < 0 || k > n ? 0.0 : factorial(n) / (factorial(k) * factorial(n - k));
}

// x^n for whole n ≥ 0, with 0^0 = 1.
double power(double x, int n) {
    return n == 0 ? 1.0 : x * power(x, n - 1);
}

// A_nl of errata 1, with (2l)!! = 2^l l!.
double normalisation(int n, int l) {
    return power(2, l) * factorial(l) *
           std::sqrt(2.0 * (n + 1) * factorial(n - l) / (std::numbers::pi * factorial(n + l + 1)));
}

// P_l^m without the Condon-Shortley phase, m ≥ 0.
double associated_legendre(int l, int m, double cos_theta, double sin_theta) {
    double below = 0;
    double value = 1;  // P_m^m = (2m−1)!! sin^m θ
    for (int i = 1; i <= m; ++i) value *= (2 * i - 1) * sin_theta;
    for (int i = m + 1; i <= l; ++i) {
        const double next = (cos_theta * (2 * i - 1) * value - (i + m - 1) * below) / (i - m);
        below = value;
        value = next;
    }
    return value;
}

// C^a_k by its explicit sum, for whole a ≥ 1.
double gegenbauer_sum(int k, int a, double x) {
    double sum = 0;
    for (int j = 0; 2 * j <= k; ++j) {
        const double coefficient = factorial(k - j + a - 1) / (factorial(a - 1) * factorial(j) * factorial(k - 2 * j));
        sum += (j % 2 == 0 ? 1 : -1) * coefficient * power(2 * x, k - 2 * j);
    }
    return sum;
}

// The appendix's Π̄_l^m as a polynomial homogeneous in x2 and r = |(x2,x3,x4)|: r^{l−m} Π̄_l^m(x2 / r).
double solid_legendre(int l, int m, double x2, double r_squared) {
    double sum = 0;
    for (int k = 0; 2 * k <= l - m; ++k) {
        const double b = (k % 2 == 0 ? 1 : -1) * power(0.5, l) * binomial(l, k) * binomial(2 * l - 2 * k, l) *
                         factorial(l - 2 * k) / factorial(l - 2 * k - m);
        sum += b * power(x2, l - 2 * k - m) * power(r_squared, k);
    }
    return std::sqrt(factorial(l - m) / factorial(l + m)) * sum;
}

// The appendix's A_m (quarter_turn 0: the cosine) and B_m (quarter_turn 1: the sine): Re and Im of (x3 + i x4)^m.
double azimuth_polynomial(int m, double x3, double x4, int quarter_turn) {
    static constexpr double kCosineOfQuarters[4] = {1, 0, -1, 0};
    double sum = 0;
    for (int p = 0; p <= m; ++p) {
        const double trigonometric = kCosineOfQuarters[(m - p + 3 * quarter_turn) % 4];
        sum += binomial(m, p) * power(x3, p) * power(x4, m - p) * trigonometric;
    }
    return sum;
}

// sin^l γ Y_lm as a solid harmonic of (x2,x3,x4), errata 3 and 4.
double solid_harmonic(int l, int m, const glm::dvec4& x) {
    const double r_squared = x.y * x.y + x.z * x.z + x.w * x.w;
    const int order = std::abs(m);
    const double legendre = solid_legendre(l, order, x.y, r_squared);
    if (m == 0) return std::sqrt((2 * l + 1) / (4 * std::numbers::pi)) * legendre;
    return std::sqrt((2 * l + 1) / (2 * std::numbers::pi)) * legendre *
           azimuth_polynomial(order, x.z, x.w, m > 0 ? 0 : 1);
}

}  // namespace

uint32_t hh_index(int n, int l, int m) {
    return static_cast<uint32_t>(n * (n + 1) * (2 * n + 1) / 6 + l * l + l + m);
}

uint32_t sh_index(int l, int m) {
    return static_cast<uint32_t>(l * l + l + m);
}

double gegenbauer(int degree, double alpha, double x) {
    double below = 0;
    double value = 1;
    for (int i = 1; i <= degree; ++i) {
        const double next = (2 * x * (i + alpha - 1) * value - (i + 2 * alpha - 2) * below) / i;
        below = value;
        value = next;
    }
    return value;
}

double radial(int n, int l, double gamma) {
    return normalisation(n, l) * power(std::sin(gamma), l) * gegenbauer(n - l, l + 1, std::cos(gamma));
}

double radial_slope(int n, int l, double gamma) {
    const double s = std::sin(gamma);
    const double c = std::cos(gamma);
    const double from_sine = l == 0 ? 0.0 : l * power(s, l - 1) * c * gegenbauer(n - l, l + 1, c);
    // d/dx C^a_k(x) = 2a C^{a+1}_{k−1}(x), and dx/dγ = −sin γ.
    const double from_gegenbauer = n == l ? 0.0 : -power(s, l + 1) * 2 * (l + 1) * gegenbauer(n - l - 1, l + 2, c);
    return normalisation(n, l) * (from_sine + from_gegenbauer);
}

double real_sh(int l, int m, double theta, double phi) {
    const int order = std::abs(m);
    const double k = std::sqrt((2 * l + 1) / (4 * std::numbers::pi) * factorial(l - order) / factorial(l + order));
    const double legendre = k * associated_legendre(l, order, std::cos(theta), std::sin(theta));
    if (m == 0) return legendre;
    return std::numbers::sqrt2 * legendre * (m > 0 ? std::cos(order * phi) : std::sin(order * phi));
}

std::vector<double> sh_basis(uint32_t degree, glm::dvec3 direction) {
    const double theta = std::atan2(std::hypot(direction.x, direction.y), direction.z);
    const double phi = std::atan2(direction.y, direction.x);
    std::vector<double> basis(sh_count(degree));
    for (int l = 0; l <= static_cast<int>(degree); ++l) {
        for (int m = -l; m <= l; ++m) basis[sh_index(l, m)] = real_sh(l, m, theta, phi);
    }
    return basis;
}

std::vector<double> hh_basis(uint32_t degree, double gamma, glm::dvec3 direction) {
    const std::vector<double> sh = sh_basis(degree, direction);
    std::vector<double> basis(hh_count(degree));
    for (int n = 0; n <= static_cast<int>(degree); ++n) {
        for (int l = 0; l <= n; ++l) {
            const double r = radial(n, l, gamma);
            for (int m = -l; m <= l; ++m) basis[hh_index(n, l, m)] = r * sh[sh_index(l, m)];
        }
    }
    return basis;
}

std::vector<double> hh_basis_cartesian(uint32_t degree, const glm::dvec4& x) {
    std::vector<double> basis(hh_count(degree));
    for (int n = 0; n <= static_cast<int>(degree); ++n) {
        for (int l = 0; l <= n; ++l) {
            // The solid harmonic already carries (1−x1²)^{l/2} = sin^l γ.
            const double radial_part = normalisation(n, l) * gegenbauer_sum(n - l, l + 1, x.x);
            for (int m = -l; m <= l; ++m) basis[hh_index(n, l, m)] = radial_part * solid_harmonic(l, m, x);
        }
    }
    return basis;
}

glm::dvec4 hypersphere_point(double gamma, glm::dvec3 direction) {
    const glm::dvec3 v = std::sin(gamma) * direction;
    return {std::cos(gamma), v.z, v.x, v.y};
}

}  // namespace neuvv::reference
