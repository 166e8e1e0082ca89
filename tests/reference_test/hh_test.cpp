#include "reference/hh.h"

#include <gtest/gtest.h>

#include "reference_test/numeric.h"

namespace neuvv::reference::test {
namespace {

constexpr double kPi = std::numbers::pi;

glm::dvec3 direction_of(double theta, double phi) {
    return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

// The polynomials that every implementation must agree with, by index l² + l + m.
std::vector<double> sh_polynomials(glm::dvec3 d) {
    const double x = d.x, y = d.y, z = d.z;
    return {0.282094791773878,
            0.488602511902920 * y,
            0.488602511902920 * z,
            0.488602511902920 * x,
            1.092548430592079 * x * y,
            1.092548430592079 * y * z,
            0.315391565252520 * (3 * z * z - 1),
            1.092548430592079 * x * z,
            0.546274215296040 * (x * x - y * y),
            0.590043589926644 * y * (3 * x * x - y * y),
            2.890611442640554 * x * y * z,
            0.457045799464466 * y * (5 * z * z - 1),
            0.373176332590115 * z * (5 * z * z - 3),
            0.457045799464466 * x * (5 * z * z - 1),
            1.445305721320277 * z * (x * x - y * y),
            0.590043589926644 * x * (x * x - 3 * y * y)};
}

TEST(Hh, CountsAndIndicesAgree) {
    const uint32_t counts[] = {1, 5, 14, 30};
    for (uint32_t degree = 0; degree <= kMaxHhDegree; ++degree) {
        EXPECT_EQ(hh_count(degree), counts[degree]);
        EXPECT_EQ(hh_basis(degree, 1.0, {0, 0, 1}).size(), counts[degree]);
        EXPECT_EQ(sh_basis(degree, {0, 0, 1}).size(), sh_count(degree));
    }
    uint32_t next = 0;
    for (int n = 0; n <= 3; ++n) {
        for (int l = 0; l <= n; ++l) {
            for (int m = -l; m <= l; ++m) EXPECT_EQ(hh_index(n, l, m), next++);
        }
    }
    EXPECT_EQ(next, kMaxHhCount);
    EXPECT_EQ(sh_index(3, 3) + 1, kMaxShCount);
}

TEST(Hh, SphericalHarmonicsAreTheKnownPolynomials) {
    Random random(1);
    for (int i = 0; i < 200; ++i) {
        const glm::dvec3 d = random_direction(random);
        const std::vector<double> expected = sh_polynomials(d);
        const std::vector<double> basis = sh_basis(3, d);
        for (size_t j = 0; j < basis.size(); ++j) EXPECT_NEAR(basis[j], expected[j], 1e-13) << j;
    }
}

// Errata 1: the measure of S³ is sin²γ sinθ dγ dθ dφ.
TEST(Hh, IsOrthonormalOnTheHypersphere) {
    std::vector<double> gram(size_t{kMaxHhCount} * kMaxHhCount);
    constexpr int kAzimuths = 16;
    for (const auto& gamma : gauss_legendre(32, 0, kPi)) {
        for (const auto& theta : gauss_legendre(24, 0, kPi)) {
            for (int k = 0; k < kAzimuths; ++k) {
                const double measure = gamma.weight * theta.weight * (2 * kPi / kAzimuths) * std::sin(gamma.x) *
                                       std::sin(gamma.x) * std::sin(theta.x);
                const std::vector<double> h = hh_basis(3, gamma.x, direction_of(theta.x, 2 * kPi * k / kAzimuths));
                for (size_t a = 0; a < h.size(); ++a) {
                    for (size_t b = 0; b < h.size(); ++b) gram[a * kMaxHhCount + b] += measure * h[a] * h[b];
                }
            }
        }
    }
    for (size_t a = 0; a < kMaxHhCount; ++a) {
        for (size_t b = 0; b < kMaxHhCount; ++b) {
            EXPECT_NEAR(gram[a * kMaxHhCount + b], a == b ? 1.0 : 0.0, 1e-6) << a << ", " << b;
        }
    }
}

TEST(Hh, CartesianFormEqualsAngularForm) {
    Random random(2);
    for (int i = 0; i < 300; ++i) {
        const double gamma = random.uniform(0, kPi);
        const glm::dvec3 d = random_direction(random);
        const std::vector<double> angular = hh_basis(3, gamma, d);
        const std::vector<double> cartesian = hh_basis_cartesian(3, hypersphere_point(gamma, d));
        for (size_t j = 0; j < angular.size(); ++j) EXPECT_NEAR(angular[j], cartesian[j], 1e-12) << j;
    }
}

TEST(Hh, CartesianFormOnTheEquatorIsTheAppendixsRealSh) {
    // At γ = π/2 and n = l the basis is A_ll Y_lm, so this tests the solid harmonics alone.
    Random random(3);
    for (int i = 0; i < 50; ++i) {
        const glm::dvec3 d = random_direction(random);
        const std::vector<double> expected = sh_polynomials(d);
        const std::vector<double> h = hh_basis_cartesian(3, {0, d.z, d.x, d.y});
        for (int l = 0; l <= 3; ++l) {
            const double scale = radial(l, l, kPi / 2);
            for (int m = -l; m <= l; ++m) {
                EXPECT_NEAR(h[hh_index(l, l, m)] / scale, expected[sh_index(l, m)], 1e-13) << l << ", " << m;
            }
        }
    }
}

TEST(Hh, PolesAreFinite) {
    for (const double gamma : {0.0, kPi}) {
        for (const glm::dvec3 d : {glm::dvec3(0, 0, 1), glm::dvec3(0, 0, -1)}) {
            const std::vector<double> angular = hh_basis(3, gamma, d);
            const std::vector<double> cartesian = hh_basis_cartesian(3, hypersphere_point(gamma, d));
            for (size_t j = 0; j < angular.size(); ++j) EXPECT_NEAR(angular[j], cartesian[j], 1e-12) << j;
        }
    }
}

TEST(Hh, RadialSlopeIsTheDerivative) {
    for (int n = 0; n <= 3; ++n) {
        for (int l = 0; l <= n; ++l) {
            for (double gamma = 0.05; gamma < kPi; gamma += 0.1) {
                const auto value = [&] { return radial(n, l, gamma); };
                EXPECT_LT(gradient_error(radial_slope(n, l, gamma), gamma, value), 1e-6) << n << ", " << l;
            }
        }
    }
}

TEST(Hh, GradientErrorNoticesAWrongDerivative) {
    double x = 1.3;
    const auto cube = [&] { return x * x * x; };
    EXPECT_LT(gradient_error(3 * x * x, x, cube), 1e-9);
    EXPECT_GT(gradient_error(3.0001 * x * x, x, cube), 1e-6);
    EXPECT_GT(gradient_error(0, x, cube), 0.5);
    EXPECT_EQ(x, 1.3);
}

}  // namespace
}  // namespace neuvv::reference::test
