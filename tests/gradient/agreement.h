// How gradients are compared: the error of each number is relative to the number, or to a thousandth of the group's
// largest where the number is smaller. Sums over hundreds of rays in single precision are not more exact than that.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace neuvv::test {

constexpr double kGradientTolerance = 1e-3;
constexpr double kSmall = 1e-3;  // of the group's largest number

struct GradientPair {
    double found = 0, truth = 0;
};

// max |found − truth| / max(|truth|, kSmall ‖truth‖∞); infinite where an error is not a number.
inline double gradient_disagreement(const std::vector<GradientPair>& group) {
    double largest = 0, worst = 0;
    for (const GradientPair& pair : group) largest = std::max(largest, std::abs(pair.truth));
    for (const GradientPair& pair : group) {
        const double error = std::abs(pair.found - pair.truth) / std::max(std::abs(pair.truth), kSmall * largest);
        worst = std::isnan(error) ? INFINITY : std::max(worst, error);
    }
    return worst;
}

// Expects that the group agrees and can fail: at least nine in ten of its truths are not 0.
inline void expect_gradients(const std::string& name, const std::vector<GradientPair>& group) {
    SCOPED_TRACE(name);
    const auto zeros = std::count_if(group.begin(), group.end(), [](const GradientPair& p) { return p.truth == 0; });
    EXPECT_GT(group.size(), 0u);
    EXPECT_LE(zeros * 10, static_cast<std::ptrdiff_t>(group.size()));
    EXPECT_LE(gradient_disagreement(group), kGradientTolerance);
}

}  // namespace neuvv::test
