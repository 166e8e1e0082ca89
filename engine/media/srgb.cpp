#include "media/srgb.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace neuvv::media {

double srgb_from_linear(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

double linear_from_srgb(double srgb) {
    return srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4);
}

float linear_from_srgb_byte(uint8_t srgb) {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> linear{};
        for (size_t i = 0; i < 256; ++i) linear[i] = static_cast<float>(linear_from_srgb(static_cast<double>(i) / 255));
        return linear;
    }();
    return table[srgb];
}

uint8_t srgb_byte_from_linear(float linear) {
    // The largest linear value of each byte: half-way to the next byte in encoded values.
    static const std::array<float, 255> edges = [] {
        std::array<float, 255> highest{};
        for (size_t i = 0; i < 255; ++i)
            highest[i] = static_cast<float>(linear_from_srgb((static_cast<double>(i) + 0.5) / 255));
        return highest;
    }();
    return static_cast<uint8_t>(std::lower_bound(edges.begin(), edges.end(), linear) - edges.begin());
}

}  // namespace neuvv::media
