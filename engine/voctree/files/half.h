// Converts between float and the bits of IEEE 754 binary16. Both functions are branch-free, so that loops vectorise.
#pragma once

#include <bit>
#include <cstdint>

namespace neuvv::voctree {

constexpr float kMaxHalf = 65504.0f;

// Rounds to nearest, ties to even. Values beyond ±65504, infinities included, become ±65504; NaN stays NaN.
inline uint16_t half_from_float(float value) {
    const uint32_t bits = std::bit_cast<uint32_t>(value);
    const uint32_t sign = bits >> 31 << 15;
    const uint32_t magnitude = bits & 0x7fffffffu;
    const uint32_t largest = std::bit_cast<uint32_t>(kMaxHalf);
    const uint32_t clamped = magnitude < largest ? magnitude : largest;
    // Normal halves: change the exponent's bias from 127 to 15, and round away the lowest 13 bits.
    const uint32_t normal = (clamped - (112u << 23) + 0xfffu + ((clamped >> 13) & 1u)) >> 13;
    // Below 2^-14: adding 0.5 makes the float unit round at 2^-24, a subnormal half's step.
    const uint32_t subnormal = std::bit_cast<uint32_t>(std::bit_cast<float>(clamped) + 0.5f) - (126u << 23);
    const uint32_t finite = clamped < (113u << 23) ? subnormal : normal;
    return static_cast<uint16_t>(sign | (magnitude > 0x7f800000u ? 0x7e00u : finite));
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
