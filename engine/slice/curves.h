// What the whole numbers of a stream's slices stand for, one by one (stream/README.md, "Planes").
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "shared/hh_counts.h"
#include "stream/codec/quantised_slice.h"

namespace neuvv::slice {

// The optical depth along the edge of a leaf, by its opacity, 0 to stream::kUnit:
float optical_depth_of(int16_t opacity);
// The density of a leaf whose edge has so many metres, 1/m.
inline float sigma_of(int16_t opacity, float edge_m) {
    return optical_depth_of(opacity) / edge_m;
}

// The same by depth and opacity of leaves in a box of this size, metres: kOpacities numbers for each depth up to
// `depth`.
constexpr size_t kOpacities = stream::kUnit + 1;
std::vector<float> sigmas_of(uint32_t depth, glm::vec3 box_size);

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

// By how much one unit of a harmonic's coefficient changes the colour where the harmonic is largest along an axis, in
// sRGB, at a colour in sRGB.
float slope_of(float srgb, uint32_t degree);

constexpr uint32_t degree_of_harmonic(uint32_t harmonic) {
    return harmonic == 0 ? 0 : harmonic < 4 ? 1 : harmonic < 9 ? 2 : 3;
}

}  // namespace neuvv::slice
