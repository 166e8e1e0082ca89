// Slices as the whole numbers that a stream has of them, and back (stream/README.md, "Planes").
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "slice/slice.h"
#include "stream/codec/quantised_slice.h"

namespace neuvv::slice {

// Less opacity along the edge of a leaf is 0 in whole numbers.
constexpr float kLeastOpacity = 0.5f / stream::kUnit;

// It has the same leaves, of which those below kLeastOpacity get an opacity of 0.
stream::QuantisedSlice quantised(const Slice& slice);

// `box_min`, `box_size`: metres. Opacities must be 0 to stream::kUnit.
Slice values_of(const stream::QuantisedSlice& slice, glm::vec3 box_min, glm::vec3 box_size);

// What single numbers stand for. The optical depth along the edge of a leaf, by its opacity, 0 to stream::kUnit:
float optical_depth_of(int16_t opacity);
// The density of a leaf whose edge has so many metres, 1/m.
inline float sigma_of(int16_t opacity, float edge_m) {
    return optical_depth_of(opacity) / edge_m;
}

// By twice the sRGB of a channel's mean colour, in units of 1 / stream::kUnit, as that may have halves: the coefficient
// k_00 in linear light, and how much one unit of a harmonic's plane is of its coefficient k_lm, by degree l.
constexpr size_t kColourHalves = 2 * stream::kUnit + 1;
struct ColourCurves {
    std::array<float, kColourHalves> constant;
    std::array<std::array<float, kColourHalves>, kMaxHhDegree + 1> per_unit;
};
const ColourCurves& colour_curves();
// The index into them; colours beyond 0 or 1 are clamped. `units` must be what planes can say: then loops vectorise.
inline uint16_t colour_half(float units) {
    constexpr int32_t kLast = kColourHalves - 1;
    return static_cast<uint16_t>(std::clamp(static_cast<int32_t>(2 * units), 0, kLast));
}

constexpr uint32_t degree_of_harmonic(uint32_t harmonic) {
    return harmonic == 0 ? 0 : harmonic < 4 ? 1 : harmonic < 9 ? 2 : 3;
}

}  // namespace neuvv::slice
