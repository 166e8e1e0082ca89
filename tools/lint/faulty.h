// See faulty.cpp.
#pragma once

#include <string>
#include <utility>

inline std::string::size_type use_after_move_in_a_header(std::string text) {
    const std::string taken = std::move(text);
    return taken.size() + text.size();
}

namespace {
inline int sides(int corners) {
    return corners;
}
}  // namespace
