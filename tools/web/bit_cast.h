// std::bit_cast, which the C++ library of Debian 12's emscripten lacks; `build` includes it before all else.
#pragma once

#include <bit>

#ifndef __cpp_lib_bit_cast
namespace std {
template <typename To, typename From>
constexpr To bit_cast(const From& from) noexcept {
    return __builtin_bit_cast(To, from);
}
}  // namespace std
#endif
