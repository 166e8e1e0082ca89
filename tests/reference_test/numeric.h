// Numerical tools of the reference's tests: random numbers, quadrature, differences.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <random>
#include <utility>
#include <vector>

namespace neuvv::reference::test {

class Random {
  public:
    explicit Random(uint32_t seed) : engine_(seed) {}
    double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(engine_); }
    uint32_t below(uint32_t end) { return std::uniform_int_distribution<uint32_t>(0, end - 1)(engine_); }
    glm::dvec3 point(double low, double high) { return {uniform(low, high), uniform(low, high), uniform(low, high)}; }
    glm::dvec3 direction() {
        std::normal_distribution<double> normal;
        return glm::normalize(glm::dvec3(normal(engine_), normal(engine_), normal(engine_)));
    }

  private:
    std::mt19937 engine_;
};

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

// How far `analytic` is from the derivative of loss() by x, relative to the derivative, with a floor of 1e-4 of the
// loss's size so that vanishing derivatives compare absolutely. Differences of fourth order.
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
