// The middle of a list of numbers.
#pragma once

#include <algorithm>
#include <vector>

namespace neuvv::motion {

// Reorders the values. 0 where there are none; the upper of the two middle ones where their number is even.
inline double median(std::vector<double>& values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

}  // namespace neuvv::motion
