#include "voctree/stream_slice.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include "base/threads/parallel.h"
#include "media/image.h"
#include "voctree/frame_leaves.h"
#include "voctree/sh_weights.h"
#include "voctree/sigmoid.h"
#include "voctree/temporal_basis.h"

namespace neuvv::voctree {

namespace {

constexpr size_t kLeavesOfPart = 4096;
// Colours and opacities that are coded as 0 or 1 are a little more or less.
constexpr float kMargin = 0.5f / stream::kUnit;
constexpr float kLeastSlope = 0.02f;

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

int16_t units(float value) {
    return static_cast<int16_t>(std::lround(std::clamp(value, -4.0f, 4.0f) * stream::kUnit));
}

uint32_t degree_of(uint32_t harmonic) {
    return harmonic == 0 ? 0 : harmonic < 4 ? 1 : harmonic < 9 ? 2 : 3;
}

void write_colours(const LeafColours& k, size_t leaf, stream::Slice& slice) {
    std::array<float, 3> srgb;
    for (size_t c = 0; c < 3; ++c) srgb[c] = srgb_of(sigmoid(k[c][0] * kMeanHarmonic));
    for (uint32_t i = 0; i < sh_count(slice.degree); ++i) {
        std::array<float, 3> shown = srgb;
        for (size_t c = 0; c < 3 && i > 0; ++c) shown[c] = k[c][i] * slope_of(srgb[c], degree_of(i));
        const stream::Ycc ycc = stream::ycc_of({shown[0], shown[1], shown[2]});
        slice.planes[1 + 3 * i][leaf] = units(ycc.y);
        slice.planes[2 + 3 * i][leaf] = units(ycc.co);
        slice.planes[3 + 3 * i][leaf] = units(ycc.cg);
    }
}

// What a channel's colour in sRGB says, in halves of 1 / stream::kUnit, of which a slice's colours are whole numbers.
struct Channel {
    float constant;                             // k_00
    std::array<float, kMaxHhDegree + 1> slope;  // slope_of, by degree
};

const Channel& channel_of(float units) {
    static const std::vector<Channel> kChannels = [] {
        std::vector<Channel> channels;
        for (uint32_t half = 0; half <= 2 * stream::kUnit; ++half) {
            const float srgb = std::clamp(static_cast<float>(half) / (2 * stream::kUnit), kMargin, 1 - kMargin);
            const float linear = linear_of(srgb);
            Channel& channel = channels.emplace_back();
            channel.constant = std::log(linear / (1 - linear)) / kMeanHarmonic;
            for (uint32_t l = 0; l < channel.slope.size(); ++l) channel.slope[l] = slope_of(srgb, l);
        }
        return channels;
    }();
    return kChannels[static_cast<size_t>(std::clamp(2 * units, 0.0f, 2.0f * stream::kUnit))];
}

LeafColours read_colours(const stream::Slice& slice, size_t leaf) {
    LeafColours k{};
    std::array<const Channel*, 3> channels{};
    for (uint32_t i = 0; i < sh_count(slice.degree); ++i) {
        const auto value = [&](uint32_t plane) { return static_cast<float>(slice.planes[plane + 3 * i][leaf]); };
        const stream::Rgb rgb = stream::rgb_of({value(1), value(2), value(3)});
        const std::array<float, 3> shown = {rgb.r, rgb.g, rgb.b};
        for (size_t c = 0; c < 3; ++c) {
            if (i == 0) channels[c] = &channel_of(shown[c]);
            k[c][i] = i == 0 ? channels[c]->constant : shown[c] / stream::kUnit / channels[c]->slope[degree_of(i)];
        }
    }
    return k;
}

// The optical depth along the edge of a leaf, by its opacity.
float optical_depth_of(int16_t opacity) {
    static const std::vector<float> kDepths = [] {
        std::vector<float> depths;
        for (int units = 0; units <= stream::kUnit; ++units)
            depths.push_back(-std::log(1 - std::min(static_cast<float>(units) / stream::kUnit, 1 - kMargin)));
        return depths;
    }();
    return kDepths[static_cast<size_t>(opacity)];
}

}  // namespace

stream::Slice slice_of(const VOctree& tree, double frame, std::span<const PaintStep> paint) {
    for ([[maybe_unused]] const PaintStep& step : paint) assert(step.layer->field.leaf_count == tree.leaf_count);
    const RowsAtTime rows(tree, frame);
    const FrameEdits edits(paint, static_cast<float>(frame));
    const std::vector<LiveLeaf> live = live_leaves(tree, rows, edits, 0.5f / stream::kUnit);
    stream::Slice slice{2 * tree.node_levels, tree.hh_degree, {}, {}};
    slice.planes.resize(stream::planes_of(slice.degree));
    for (auto& plane : slice.planes) plane.resize(live.size());
    slice.leaves.resize(live.size());
    parallel_for(live.size(), kLeavesOfPart, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            slice.leaves[i] = {live[i].cell, live[i].depth};
            slice.planes[stream::kOpacityPlane][i] = units(live[i].opacity);
            write_colours(leaf_colours(tree, live[i].leaf, rows, edits), i, slice);
        }
    });
    return slice;
}

VOctree tree_of(const stream::Slice& slice, glm::vec3 box_min, glm::vec3 box_size, float fps) {
    assert(slice.depth % 2 == 0);
    VOctree tree;
    tree.box_min = box_min;
    tree.box_size = box_size;
    tree.node_levels = slice.depth / 2;
    tree.fps = fps;
    make_still(tree, slice.degree);
    std::vector<LeafPosition> positions;
    positions.reserve(slice.leaves.size());
    for (const stream::Leaf& leaf : slice.leaves)
        positions.push_back(position_of(leaf.cell >> 3 * (slice.depth - leaf.depth), leaf.depth));
    build_topology(tree, positions);
    std::array<float, stream::kMaxDepth + 1> edges;
    for (uint32_t d = 0; d < edges.size(); ++d) edges[d] = leaf_edge_m(tree, d);
    parallel_for(slice.leaves.size(), kLeavesOfPart, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            float* weights = tree.leaf(static_cast<uint32_t>(i));
            weights[0] = optical_depth_of(slice.planes[stream::kOpacityPlane][i]) / edges[slice.leaves[i].depth];
            const LeafColours k = read_colours(slice, i);
            for (uint32_t c = 0; c < 3; ++c)
                write_sh(weights + 2 + c * hh_count(slice.degree), slice.degree, k[c].data());
        }
    });
    return tree;
}

}  // namespace neuvv::voctree
