// std::from_chars of a double, which the C++ library of Debian 12's emscripten lacks; `build` includes it before all
// else.
#pragma once

#include <charconv>

#ifndef __cpp_lib_to_chars
#include <algorithm>
#include <cstdlib>
#include <string>

namespace std {
// Decimal digits alone: what strtod takes besides, such as spaces and hexadecimal digits, from_chars does not.
inline from_chars_result from_chars(const char* first, const char* last, double& value) {
    string digits(first, last);
    digits.resize(min(digits.find_first_not_of("0123456789.eE+-"), digits.size()));
    char* end = nullptr;
    const double read = digits.empty() || digits[0] == '+' ? 0 : strtod(digits.c_str(), &end);
    if (end == nullptr || end == digits.c_str()) return {first, errc::invalid_argument};
    value = read;
    return {first + (end - digits.c_str()), errc()};
}
}  // namespace std
#endif
