// Converts between float and the bits of IEEE 754 binary16. Both functions are branch-free, so that loops vectorise.
#pragma once

#include <bit>
#include <cstdint>

namespace neuvv::voctree {

constexpr float kMaxHalf = 65504.0f;

// Rounds to nearest, ties to even. Values beyond ±65504, infinities included, become ±65504; NaN stays NaN.
inline uint16_t half_from_float(float value) {
    // Signed, as not every processor compares unsigned numbers in a vector.
    const int32_t bits = std::bit_cast<int32_t>(value), magnitude = bits & 0x7fffffff;
    constexpr int32_t kLargest = std::bit_cast<int32_t>(kMaxHalf);
    const int32_t sign = bits >> 16 & 0x8000, clamped = magnitude < kLargest ? magnitude : kLargest;
    // Normal halves: change the exponent's bias from 127 to 15, and round away the lowest 13 bits.
    const int32_t normal = (clamped - (112 << 23) + 0xfff + (clamped >> 13 & 1)) >> 13;
    // Below 2^-14: adding 0.5 makes the float unit round at 2^-24, a subnormal half's step.
    const int32_t subnormal = std::bit_cast<int32_t>(std::bit_cast<float>(clamped) + 0.5f) - (126 << 23);
    const int32_t is_small = -int32_t{clamped < 113 << 23}, is_nan = -int32_t{magnitude > 0x7f800000};  // masks
    const int32_t finite = (subnormal & is_small) | (normal & ~is_small);
    return static_cast<uint16_t>(sign | (is_nan & 0x7e00) | (finite & ~is_nan));
}

// The conversion is exact.
inline float float_from_half(uint16_t half) {
    const uint32_t sign = (uint32_t{half} & 0x8000u) << 16;
    const uint32_t shifted = (uint32_t{half} & 0x7fffu) << 13;
    const uint32_t normal = shifted + (112u << 23);
    const uint32_t infinite_or_nan = shifted + (224u << 23);
    // A subnormal half is m·2^-24: make m the fraction of 2^-14 · (1 + m / 1024), then subtract 2^-14.
    const uint32_t subnormal = std::bit_cast<uint32_t>(std::bit_cast<float>(shifted + (113u << 23)) - 0x1p-14f);
    const uint32_t finite = shifted < (1u << 23) ? subnormal : normal;
    return std::bit_cast<float>(sign | (shifted >= (31u << 23) ? infinite_or_nan : finite));
}

}  // namespace neuvv::voctree
