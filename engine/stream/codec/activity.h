// How large the coefficients around are, on which the tables of coefficients depend.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "stream/codec/symbols.h"

namespace neuvv::stream {

// 0 to 15: half of what it is around the larger cell, and twice the coefficient that divides that one. It is half in a
// cell without any.
using Activity = uint8_t;
// `symbol` is that of the coefficient, at most kEscape.
inline Activity activity_below(Activity activity, uint32_t symbol) {
    return static_cast<Activity>(std::min(activity / 2u + ((symbol + 1) & ~1u), 15u));
}
constexpr std::array<uint8_t, 16> kActivityContexts = {0, 1, 2, 3, 3, 4, 4, 4, 5, 5, 5, 5, 5, 5, 5, 5};
inline uint32_t activity_context(Activity activity) {
    return kActivityContexts[activity];
}

// Numbers as symbols: 0, 1, −1, 2 … Those from kEscape on follow an escape.
constexpr uint32_t kEscape = kNumbers - 1;
constexpr uint32_t folded(int32_t number) {
    return static_cast<uint32_t>(number > 0 ? 2 * number - 1 : -2 * number);
}

// The first of the tables of a kind of planes at a depth, by activity_context. There are classes of depths: that of the
// finest pairs, the next, all others.
inline uint32_t first_plane_table(uint32_t kind, size_t depth, uint32_t finest) {
    const auto depth_class = static_cast<uint32_t>(std::min<size_t>(finest - 1 - depth, kDepthClasses - 1));
    return (kind * kDepthClasses + depth_class) * kActivities;
}

}  // namespace neuvv::stream
