// Poses at random, seeded, and what is not one.
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
    glm::dvec3 vector(double most) { return {number(-most, most), number(-most, most), number(-most, most)}; }
    glm::dquat rotation() {  // even over all: a direction of four normal numbers
        std::normal_distribution<double> normal;
        return glm::normalize(glm::dquat(normal(random_), normal(random_), normal(random_), normal(random_)));
    }
    xr::Pose pose(double most_m = 2) { return {vector(most_m), rotation()}; }
    // Not far from another, as a hand is a frame later.
    xr::Pose near(const xr::Pose& pose, double by_m, double by_rad) {
        const glm::dvec3 axis = glm::normalize(vector(1) + glm::dvec3(1e-3));
        return {pose.position + vector(by_m), glm::angleAxis(number(-by_rad, by_rad), axis) * pose.rotation};
    }

  private:
    std::mt19937 random_;
};

// None of them is sound.
inline std::vector<xr::Pose> invalid_poses() {
    return {{{kNan, 0, 0}, {1, 0, 0, 0}},       {{0, kInfinite, 0}, {1, 0, 0, 0}}, {{0, 0, 0}, {kNan, 0, 0, 0}},
            {{0, 0, 0}, {1, 0, -kInfinite, 0}}, {{0, 0, 0}, {0, 0, 0, 0}},         {{0, 0, 1e200}, {1, 0, 0, 0}},
            {{0, 0, 0}, {1e200, 0, 0, 0}}};
}

inline double max_difference(const glm::dmat4& a, const glm::dmat4& b) {
    double most = 0;
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j) {
            const double difference = std::abs(a[i][j] - b[i][j]);
            if (!(difference <= most)) most = difference;  // NaN stays
            if (std::isnan(most)) return kInfinite;
        }
    return most;
}

}  // namespace neuvv::test
