// Random poses from a seed, and invalid ones.
#pragma once

#include <limits>
#include <random>
#include <vector>

#include "xr/pose.h"

namespace neuvv::test {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

class RandomPoses {
  public:
    explicit RandomPoses(uint32_t seed) : random_(seed) {}

    double number(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
    glm::dvec3 vector(double max) { return {number(-max, max), number(-max, max), number(-max, max)}; }
    glm::dquat rotation() {  // uniform over all rotations: four normally distributed numbers, normalised
        std::normal_distribution<double> normal;
        return glm::normalize(glm::dquat(normal(random_), normal(random_), normal(random_), normal(random_)));
    }
    xr::Pose pose(double max_m = 2) { return {vector(max_m), rotation()}; }
    // A pose near another one, as a hand's is a frame later.
    xr::Pose near(const xr::Pose& pose, double by_m, double by_rad) {
        const glm::dvec3 axis = glm::normalize(vector(1) + glm::dvec3(1e-3));
        return {pose.position + vector(by_m), glm::angleAxis(number(-by_rad, by_rad), axis) * pose.rotation};
    }

  private:
    std::mt19937 random_;
};

// Poses for which is_valid is false.
inline std::vector<xr::Pose> invalid_poses() {
    return {{{kNan, 0, 0}, {1, 0, 0, 0}},       {{0, kInfinite, 0}, {1, 0, 0, 0}}, {{0, 0, 0}, {kNan, 0, 0, 0}},
            {{0, 0, 0}, {1, 0, -kInfinite, 0}}, {{0, 0, 0}, {0, 0, 0, 0}},         {{0, 0, 1e200}, {1, 0, 0, 0}},
            {{0, 0, 0}, {1e200, 0, 0, 0}}};
}

inline double max_difference(const glm::dmat4& a, const glm::dmat4& b) {
    double max = 0;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            const double difference = std::abs(a[i][j] - b[i][j]);
            if (!(difference <= max)) max = difference;  // NaN is kept
            if (std::isnan(max)) return kInfinite;
        }
    return max;
}

}  // namespace neuvv::test
