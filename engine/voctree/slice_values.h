// What the whole numbers of a slice stand for (stream/README.md, "Planes").
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shared/hh_counts.h"
#include "stream/codec/quantised_slice.h"
#include "voctree/slice_paint.h"
#include "voctree/voctree.h"

namespace neuvv::voctree {

// Where the leaves of a slice lie, in its order.
std::vector<LeafPosition> leaf_positions(const stream::Slice& slice);

// The optical depth along the edge of a leaf, by its opacity, 0 to stream::kUnit.
float optical_depth_of(int16_t opacity);

// By twice the sRGB of a channel's mean colour, in units of 1 / stream::kUnit, as that may have halves: the coefficient
// k_00 in linear light, and how much one unit of a harmonic's plane is of its coefficient k_lm, by degree l.
constexpr size_t kColourHalves = 2 * stream::kUnit + 1;
struct ColourCurves {
    std::array<float, kColourHalves> constant;
    std::array<uint16_t, kColourHalves> constant_halves;  // the same as fp16
    std::array<std::array<float, kColourHalves>, kMaxHhDegree + 1> per_unit;
};
const ColourCurves& colour_curves();
// The index into them; colours beyond 0 or 1 are clamped.
inline size_t colour_half(float units) {
    constexpr float kLast = kColourHalves - 1;
    return static_cast<size_t>(2 * units < 0 ? 0 : 2 * units > kLast ? kLast : 2 * units);
}

// The colours of a leaf: sigmoid(Σ k_lm Y_lm(d)) is linear light.
LeafColours colours_of(const stream::Slice& slice, size_t leaf);
// The inverse, rounded: sets the leaf's planes but that of the opacity.
void set_colours(const LeafColours& k, size_t leaf, stream::Slice& slice);

constexpr uint32_t degree_of_harmonic(uint32_t harmonic) {
    return harmonic == 0 ? 0 : harmonic < 4 ? 1 : harmonic < 9 ? 2 : 3;
}

// The nearest whole number of units, between −4 and 4.
int16_t units_of(float value);

}  // namespace neuvv::voctree
