#include "slice/quantise.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/sigmoid.h"
#include "base/threads/parallel.h"
#include "media/image.h"

namespace neuvv::slice {

namespace {

// Colours and opacities that are coded as 0 or 1 are a little more or less.
constexpr float kMargin = 0.5f / stream::kUnit;
constexpr float kLeastSlope = 0.02f;
constexpr size_t kLeavesOfPart = 4096;

float srgb_of(float linear) {
    return static_cast<float>(media::srgb_from_linear(double{linear}));
}

float linear_of(float srgb) {
    return static_cast<float>(media::linear_from_srgb(double{srgb}));
}

// By how much one unit of a harmonic's coefficient changes the colour where the harmonic is largest along an axis, in
// sRGB, at a colour in sRGB.
float slope_of(float srgb, uint32_t l) {
    const float linear = linear_of(srgb);
    const float curve = linear <= 0.0031308f ? 12.92f : 1.055f / 2.4f * std::pow(linear, 1 / 2.4f - 1);
    const float largest = std::sqrt((2.0f * static_cast<float>(l) + 1) / (4 * std::numbers::pi_v<float>));
    return std::max(curve * linear * (1 - linear), kLeastSlope) * largest;
}

}  // namespace

float optical_depth_of(int16_t opacity) {
    static const std::vector<float> kDepths = [] {
        std::vector<float> depths;
        for (int units = 0; units <= stream::kUnit; ++units)
            depths.push_back(-std::log(1 - std::min(static_cast<float>(units) / stream::kUnit, 1 - kMargin)));
        return depths;
    }();
    return kDepths[static_cast<size_t>(opacity)];
}

const ColourCurves& colour_curves() {
    static const ColourCurves kCurves = [] {
        ColourCurves curves;
        for (size_t half = 0; half < kColourHalves; ++half) {
            const float srgb = std::clamp(static_cast<float>(half) / (2 * stream::kUnit), kMargin, 1 - kMargin);
            const float linear = linear_of(srgb);
            curves.constant[half] = std::log(linear / (1 - linear)) / kMeanHarmonic;
            for (uint32_t l = 0; l < curves.per_unit.size(); ++l)
                curves.per_unit[l][half] = 1 / (stream::kUnit * slope_of(srgb, l));
        }
        return curves;
    }();
    return kCurves;
}

namespace {

Colours colours_of(const stream::QuantisedSlice& slice, size_t leaf) {
    const ColourCurves& curves = colour_curves();
    Colours k{};
    std::array<size_t, 3> halves{};
    for (uint32_t i = 0; i < sh_count(slice.degree); ++i) {
        const auto value = [&](uint32_t plane) { return static_cast<float>(slice.planes[plane + 3 * i][leaf]); };
        const stream::Rgb rgb = stream::rgb_of({value(1), value(2), value(3)});
        const std::array<float, 3> shown = {rgb.r, rgb.g, rgb.b};
        for (size_t c = 0; c < 3; ++c) {
            if (i == 0) halves[c] = colour_half(shown[c]);
            k[c][i] =
                i == 0 ? curves.constant[halves[c]] : shown[c] * curves.per_unit[degree_of_harmonic(i)][halves[c]];
        }
    }
    return k;
}

// The nearest whole number of units, between −4 and 4.
int16_t units_of(float value) {
    return static_cast<int16_t>(std::lround(std::clamp(value, -4.0f, 4.0f) * stream::kUnit));
}

// The inverse of colours_of, rounded.
void set_colours(const Colours& k, size_t leaf, stream::QuantisedSlice& slice) {
    std::array<float, 3> srgb;
    for (size_t c = 0; c < 3; ++c) srgb[c] = srgb_of(sigmoid(k[c][0] * kMeanHarmonic));
    for (uint32_t i = 0; i < sh_count(slice.degree); ++i) {
        std::array<float, 3> shown = srgb;
        for (size_t c = 0; c < 3 && i > 0; ++c) shown[c] = k[c][i] * slope_of(srgb[c], degree_of_harmonic(i));
        const stream::Ycc ycc = stream::ycc_of({shown[0], shown[1], shown[2]});
        slice.planes[1 + 3 * i][leaf] = units_of(ycc.y);
        slice.planes[2 + 3 * i][leaf] = units_of(ycc.co);
        slice.planes[3 + 3 * i][leaf] = units_of(ycc.cg);
    }
}

}  // namespace

stream::QuantisedSlice quantised(const Slice& slice) {
    stream::QuantisedSlice whole{slice.depth, slice.degree, {}, {}};
    whole.leaves.resize(slice.leaves.size());
    whole.planes.resize(stream::planes_of(slice.degree));
    for (auto& plane : whole.planes) plane.resize(slice.leaves.size());
    parallel_for(slice.leaves.size(), kLeavesOfPart, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const Leaf& leaf = slice.leaves[i];
            whole.leaves[i] = {leaf.cell, leaf.depth};
            whole.planes[stream::kOpacityPlane][i] = units_of(slice.opacity(leaf));
            set_colours(leaf.colours, i, whole);
        }
    });
    return whole;
}

Slice values_of(const stream::QuantisedSlice& slice, glm::vec3 box_min, glm::vec3 box_size) {
    Slice values{box_min, box_size, slice.depth, slice.degree, {}};
    values.leaves.resize(slice.leaves.size());
    parallel_for(slice.leaves.size(), kLeavesOfPart, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            Leaf& leaf = values.leaves[i];
            leaf = {slice.leaves[i].cell, slice.leaves[i].depth, 0, colours_of(slice, i), 0};
            leaf.sigma = sigma_of(slice.planes[stream::kOpacityPlane][i], values.edge_m(leaf));
            leaf.shown = values.shown_alone(leaf);
        }
    });
    return values;
}

}  // namespace neuvv::slice
