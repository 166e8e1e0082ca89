#include "slice/quantise.h"

#include <algorithm>
#include <cmath>

#include "base/sigmoid.h"
#include "base/threads/parallel.h"
#include "media/srgb.h"

namespace neuvv::slice {

namespace {

constexpr size_t kLeavesOfPart = 4096;

float srgb_of(float linear) {
    return static_cast<float>(media::srgb_from_linear(double{linear}));
}

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
