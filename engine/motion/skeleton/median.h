// The middle of a list of numbers.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace neuvv::motion {

// Reorders the values. 0 where there are none; the upper of the two middle ones where their number is even.
inline double median(std::vector<double>& values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

// The middle of angles in radians, robust against those that are wrong for less than half of the time.
inline double median_angle(std::vector<double> angles) {
    double sine = 0, cosine = 0;
    for (const double angle : angles) sine += std::sin(angle), cosine += std::cos(angle);
    const double mean = std::atan2(sine, cosine);
    for (double& angle : angles) angle = std::remainder(angle - mean, 2 * std::numbers::pi);
    return mean + median(angles);
}

}  // namespace neuvv::motion
