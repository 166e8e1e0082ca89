// Numerical tools for tests of the reference: random numbers, quadrature, differences.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <vector>

#include "support/random_tree.h"

namespace neuvv::reference::test {

using neuvv::test::Random;

inline glm::dvec3 random_point(Random& random, double low, double high) {
    const double x = random.uniform(low, high), y = random.uniform(low, high), z = random.uniform(low, high);
    return {x, y, z};
}

inline glm::dvec3 random_direction(Random& random) {
    const double z = random.uniform(-1, 1);
    const double phi = random.uniform(0, 2 * std::numbers::pi);
    const double r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

struct QuadraturePoint {
    double x = 0;
    double weight = 0;
};

// Gauss-Legendre points on [low, high], roots by Newton's method.
inline std::vector<QuadraturePoint> gauss_legendre(int count, double low, double high) {
    std::vector<QuadraturePoint> points;
    for (int i = 0; i < count; ++i) {
        double x = std::cos(std::numbers::pi * (i + 0.75) / (count + 0.5));
        double slope = 1;
        for (int iteration = 0; iteration < 50; ++iteration) {
            double below = 1;
            double value = x;
            for (int k = 2; k <= count; ++k) {
                const double next = ((2 * k - 1) * x * value - (k - 1) * below) / k;
                below = value;
                value = next;
            }
            slope = count * (x * value - below) / (x * x - 1);
            x -= value / slope;
        }
        const double weight = 2 / ((1 - x * x) * slope * slope);
        points.push_back({0.5 * (low + high) + 0.5 * (high - low) * x, 0.5 * (high - low) * weight});
    }
    return points;
}

// The error of `analytic` as the derivative of loss() by x, relative to the derivative or at least to 1e-4 of the loss,
// so that vanishing derivatives are compared absolutely. The derivative is computed by differences of fourth order.
template <typename Loss>
double gradient_error(double analytic, double& x, const Loss& loss, double step = 1e-3) {
    const double x0 = x;
    const auto at = [&](double offset) {
        x = x0 + offset * step;
        return loss();
    };
    const double numeric = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * step);
    x = x0;
    const double floor = 1e-4 * std::abs(loss());
    return std::abs(analytic - numeric) / std::max({std::abs(analytic), std::abs(numeric), floor, 1e-30});
}

}  // namespace neuvv::reference::test
