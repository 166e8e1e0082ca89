#include "voctree/coarse.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>

#include "base/threads/parallel.h"
#include "voctree/round.h"
#include "voctree/temporal_basis.h"

namespace neuvv::voctree {

namespace {

constexpr uint32_t kMinReduction = 32;      // the tree has at least this many times the leaves of its coarse copy
constexpr float kRoundingError = 1 / 8.0f;  // of round_weights; merging leaves makes larger errors

struct CodedLeaf {
    uint64_t code;
    uint32_t leaf;
};

std::vector<CodedLeaf> sorted_leaves(const VOctree& tree, const std::vector<LeafPosition>& positions) {
    std::vector<CodedLeaf> sorted(positions.size());
    for (uint32_t i = 0; i < positions.size(); ++i) sorted[i] = {first_cell(positions[i], 2 * tree.node_levels), i};
    const auto before = [](const CodedLeaf& a, const CodedLeaf& b) { return a.code < b.code; };
    if (!std::is_sorted(sorted.begin(), sorted.end(), before)) std::sort(sorted.begin(), sorted.end(), before);
    return sorted;
}

// The number of leaves after a cut at each depth. Two neighbours in the sorted list stay separate leaves from the depth
// on at which their codes differ.
std::array<size_t, 2 * kMaxNodeLevels + 1> leaves_of_cuts(const std::vector<CodedLeaf>& sorted, uint32_t finest) {
    std::array<size_t, 2 * kMaxNodeLevels + 1> counts{};
    for (size_t i = 1; i < sorted.size(); ++i) {
        const auto digits = static_cast<uint32_t>(std::bit_width(sorted[i].code ^ sorted[i - 1].code) + 2) / 3;
        ++counts[finest - digits + 1];
    }
    ++counts[0];
    for (size_t depth = 1; depth <= finest; ++depth) counts[depth] += counts[depth - 1];
    return counts;
}

// Bases that are the only ones of their frames, with positive entries: there a weight below 0 is as empty as 0, and
// counts as 0 in a mean.
std::vector<bool> lone_bases(const VOctree& tree, const std::vector<BasisEntry>& entries) {
    std::vector<uint32_t> in_frame(tree.frames);
    for (const BasisEntry& entry : entries) ++in_frame[entry.frame];
    std::vector<bool> lone(tree.bases, true);
    for (const BasisEntry& entry : entries)
        if (in_frame[entry.frame] > 1 || entry.value < 0) lone[entry.basis] = false;
    return lone;
}

// Merges the leaves of one cell, which are octants of it.
struct Merger {
    const VOctree& tree;
    const std::vector<BasisEntry>&sigma_entries, &gamma_entries;
    float edge_m = 1;  // of a leaf; the cell's is twice as long
    std::vector<bool> lone = lone_bases(tree, sigma_entries);
    std::vector<float> sigma = std::vector<float>(tree.frames), opacity = sigma;
    std::vector<float> share = std::vector<float>(tree.bases), share_sum = share, wanted = share, given = share;
    std::vector<std::array<float, 12>> depths = std::vector<std::array<float, 12>>(tree.frames);  // of columns
    float colour_sum = 0;

    void clear() {
        std::fill(share_sum.begin(), share_sum.end(), 0.0f);
        std::fill(depths.begin(), depths.end(), std::array<float, 12>{});
        colour_sum = 0;
    }

    // Adds a leaf's weights to `sums`, and its optical depth to the columns that it is part of: of each axis, the cell
    // has four, two leaves long.
    void add(const float* leaf, const LeafPosition& position, float* sums) {
        const uint32_t x = position.x & 1, y = position.y & 1, z = position.z & 1;
        density_of_frames(leaf, sigma_entries, sigma);
        float coverage = 0;  // the sum over frames of the leaf's opacity
        for (uint32_t t = 0; t < tree.frames; ++t) {
            if (sigma[t] == 0) {
                opacity[t] = 0;
                continue;
            }
            const float depth = sigma[t] * edge_m;
            for (const uint32_t column : {2 * y + z, 4 + 2 * z + x, 8 + 2 * x + y}) depths[t][column] += depth;
            coverage += opacity[t] = 1 - std::exp(-depth);
        }
        std::fill(share.begin(), share.end(), 0.0f);
        for (const BasisEntry& entry : gamma_entries)
            share[entry.basis] += std::abs(entry.value) * opacity[entry.frame];
        for (uint32_t c = 0; c < tree.bases; ++c) {
            sums[c] += (lone[c] ? std::max(leaf[c], 0.0f) : leaf[c]) / 8;
            sums[tree.bases + c] += share[c] * leaf[tree.bases + c];
            share_sum[c] += share[c];
        }
        for (uint32_t w = 2 * tree.bases; w < tree.weights_per_leaf(); ++w) sums[w] += coverage * leaf[w];
        colour_sum += coverage;
    }

    // The density that passes as much light along an edge of the cell as the columns do in the mean, along the axis on
    // which they pass most.
    float density_of_columns(const std::array<float, 12>& of_frame) const {
        float through = 0;
        for (uint32_t axis = 0; axis < 3; ++axis) {
            float sum = 0;
            for (uint32_t column = 4 * axis; column < 4 * axis + 4; ++column) sum += std::exp(-of_frame[column]);
            through = std::max(through, sum / 4);
        }
        return through > 0 ? -std::log(through) / (2 * edge_m) : std::numeric_limits<float>::infinity();
    }

    // Scales mean density weights: those of a frame with bases of its own to the density of its columns, those of
    // shared bases by the mean scale of the frames where they count.
    void scale_density(float* sums) {
        std::fill(wanted.begin(), wanted.end(), 0.0f);
        std::fill(given.begin(), given.end(), 0.0f);
        density_of_frames(sums, sigma_entries, sigma);
        for (uint32_t t = 0; t < tree.frames; ++t)
            opacity[t] = sigma[t] > 0 ? std::min(sigma[t], density_of_columns(depths[t])) : 0;
        for (const BasisEntry& entry : sigma_entries) {
            wanted[entry.basis] += std::abs(entry.value) * opacity[entry.frame];
            given[entry.basis] += std::abs(entry.value) * sigma[entry.frame];
        }
        for (uint32_t c = 0; c < tree.bases; ++c)
            if (given[c] > 0) sums[c] *= wanted[c] / given[c];
    }

    // Turns sums into the cell's weights. The sums of what is visible in no frame are 0 and stay so.
    void finish(float* sums) {
        scale_density(sums);
        for (uint32_t c = 0; c < tree.bases; ++c)
            if (share_sum[c] > 0) sums[tree.bases + c] /= share_sum[c];
        for (uint32_t w = 2 * tree.bases; w < tree.weights_per_leaf(); ++w)
            if (colour_sum > 0) sums[w] /= colour_sum;
    }
};

// All but leaves and weights.
VOctree clip_without_leaves(const VOctree& tree) {
    VOctree clip;
    clip.box_min = tree.box_min;
    clip.box_size = tree.box_size;
    clip.bases = tree.bases;
    clip.hh_degree = tree.hh_degree;
    clip.frames = tree.frames;
    clip.fps = tree.fps;
    clip.has_srgb_colours = tree.has_srgb_colours;
    clip.sigma_basis = tree.sigma_basis;
    clip.gamma_basis = tree.gamma_basis;
    return clip;
}

// Merges the leaves below `depth`, all of which are at the next depth.
VOctree cut_once(const VOctree& tree, uint32_t depth) {
    const std::vector<LeafPosition> positions = leaf_positions(tree);
    const std::vector<CodedLeaf> sorted = sorted_leaves(tree, positions);
    const uint32_t below = 3 * (2 * tree.node_levels - depth);
    std::vector<size_t> first;  // for each coarse leaf the index of its first leaf in `sorted`; then the end
    std::vector<LeafPosition> coarse_positions;
    for (size_t i = 0; i < sorted.size(); ++i) {
        if (i > 0 && sorted[i].code >> below == sorted[i - 1].code >> below) continue;
        first.push_back(i);
        const LeafPosition& at = positions[sorted[i].leaf];
        const uint32_t finer = at.depth > depth ? 1 : 0;
        coarse_positions.push_back({at.x >> finer, at.y >> finer, at.z >> finer, at.depth - finer});
    }
    first.push_back(sorted.size());

    VOctree coarse = clip_without_leaves(tree);
    coarse.node_levels = (depth + 1) / 2;
    build_topology(coarse, coarse_positions);
    const std::vector<BasisEntry> sigma_entries = basis_entries(tree.sigma_basis, tree.bases);
    const std::vector<BasisEntry> gamma_entries = basis_entries(tree.gamma_basis, tree.bases);
    parallel_for(coarse.leaf_count, 256, [&](size_t begin, size_t end) {
        Merger merger{tree, sigma_entries, gamma_entries, leaf_edge_m(tree, depth + 1)};
        for (size_t i = begin; i < end; ++i) {
            float* sums = coarse.leaf(static_cast<uint32_t>(i));
            if (positions[sorted[first[i]].leaf].depth <= depth) {  // a leaf above the cut is copied
                std::copy_n(tree.leaf(sorted[first[i]].leaf), tree.weights_per_leaf(), sums);
                continue;
            }
            merger.clear();
            for (size_t at = first[i]; at < first[i + 1]; ++at)
                merger.add(tree.leaf(sorted[at].leaf), positions[sorted[at].leaf], sums);
            merger.finish(sums);
        }
    });
    return coarse;
}

}  // namespace

uint32_t finest_depth(const VOctree& tree) {
    uint32_t finest = 1;
    for (const LeafPosition& position : leaf_positions(tree)) finest = std::max(finest, position.depth);
    return finest;
}

VOctree cut_tree(const VOctree& tree, uint32_t depth) {
    uint32_t finest = finest_depth(tree);
    if (finest <= depth) return tree;
    VOctree cut = cut_once(tree, --finest);
    while (finest > depth) cut = cut_once(cut, --finest);
    return cut;
}

std::optional<VOctree> coarse_tree(const VOctree& tree) {
    if (tree.leaf_count < kMinLeavesForCoarse) return std::nullopt;
    const auto counts = leaves_of_cuts(sorted_leaves(tree, leaf_positions(tree)), 2 * tree.node_levels);
    uint32_t depth = 2 * tree.node_levels;
    while (depth > 1 && counts[depth] > tree.leaf_count / kMinReduction) --depth;
    VOctree coarse = cut_tree(tree, depth);
    round_weights(coarse, kRoundingError);
    return coarse;
}

}  // namespace neuvv::voctree
