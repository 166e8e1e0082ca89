#include "voctree/coarse.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/parallel.h"
#include "voctree/leaf_density.h"
#include "voctree/round.h"

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
    for (uint32_t i = 0; i < positions.size(); i++) sorted[i] = {first_cell(positions[i], 2 * tree.node_levels), i};
    const auto before = [](const CodedLeaf& a, const CodedLeaf& b) { return a.code < b.code; };
    if (!std::is_sorted(sorted.begin(), sorted.end(), before)) std::sort(sorted.begin(), sorted.end(), before);
    return sorted;
}

// The number of leaves after a cut at each depth. Two neighbours in the sorted list stay separate leaves from the depth
// on at which their codes differ.
std::array<size_t, 2 * kMaxNodeLevels + 1> leaves_of_cuts(const std::vector<CodedLeaf>& sorted, uint32_t finest) {
    std::array<size_t, 2 * kMaxNodeLevels + 1> counts{};
    for (size_t i = 1; i < sorted.size(); i++) {
        const auto digits = static_cast<uint32_t>(std::bit_width(sorted[i].code ^ sorted[i - 1].code) + 2) / 3;
        counts[finest - digits + 1]++;
    }
    counts[0]++;
    for (size_t depth = 1; depth <= finest; depth++) counts[depth] += counts[depth - 1];
    return counts;
}

// Bases that are the only ones of their frames, with positive entries: there a weight below 0 is as empty as 0, and
// counts as 0 in a mean.
std::vector<bool> lone_bases(const VOctree& tree, const std::vector<BasisEntry>& entries) {
    std::vector<uint32_t> in_frame(tree.frames);
    for (const BasisEntry& entry : entries) in_frame[entry.frame]++;
    std::vector<bool> lone(tree.bases, true);
    for (const BasisEntry& entry : entries)
        if (in_frame[entry.frame] > 1 || entry.value < 0) lone[entry.basis] = false;
    return lone;
}

// Computes the weighted means of the leaves of one cell.
struct Merger {
    const VOctree& tree;
    const std::vector<BasisEntry>&sigma_entries, &gamma_entries;
    std::vector<bool> lone = lone_bases(tree, sigma_entries);
    std::vector<float> sigma = std::vector<float>(tree.frames), opacity = sigma;
    std::vector<float> share = std::vector<float>(tree.bases), share_sum = share;
    float colour_sum = 0;

    void clear() {
        std::fill(share_sum.begin(), share_sum.end(), 0.0f);
        colour_sum = 0;
    }

    // Adds a leaf's weights to `sums`. `edge` is the leaf's edge as a share of the cell's.
    void add(const float* leaf, float edge_m, float edge, float* sums) {
        density_of_frames(leaf, sigma_entries, sigma);
        float coverage = 0;  // the sum over frames of opacity times the leaf's share of the cell's face
        for (uint32_t t = 0; t < tree.frames; t++)
            coverage += opacity[t] = edge * edge * (1 - std::exp(-sigma[t] * edge_m));
        std::fill(share.begin(), share.end(), 0.0f);
        for (const BasisEntry& entry : gamma_entries)
            share[entry.basis] += std::abs(entry.value) * opacity[entry.frame];
        for (uint32_t c = 0; c < tree.bases; c++) {
            sums[c] += edge * edge * edge * (lone[c] ? std::max(leaf[c], 0.0f) : leaf[c]);
            sums[tree.bases + c] += share[c] * leaf[tree.bases + c];
            share_sum[c] += share[c];
        }
        for (uint32_t w = 2 * tree.bases; w < tree.weights_per_leaf(); w++) sums[w] += coverage * leaf[w];
        colour_sum += coverage;
    }

    // Turns sums into means. The sums of what is visible in no frame are 0 and stay so.
    void divide(float* sums) const {
        for (uint32_t c = 0; c < tree.bases; c++)
            if (share_sum[c] > 0) sums[tree.bases + c] /= share_sum[c];
        for (uint32_t w = 2 * tree.bases; w < tree.weights_per_leaf(); w++)
            if (colour_sum > 0) sums[w] /= colour_sum;
    }
};

VOctree cut_sorted(const VOctree& tree, const std::vector<LeafPosition>& positions,
                   const std::vector<CodedLeaf>& sorted, uint32_t depth) {
    const uint32_t below = 3 * (2 * tree.node_levels - depth);
    std::vector<size_t> first;  // for each coarse leaf the index of its first leaf in `sorted`; then the end
    std::vector<LeafPosition> coarse_positions;
    for (size_t i = 0; i < sorted.size(); i++) {
        if (i > 0 && sorted[i].code >> below == sorted[i - 1].code >> below) continue;
        first.push_back(i);
        const LeafPosition& position = positions[sorted[i].leaf];
        const uint32_t finer = position.depth - std::min(position.depth, depth);
        coarse_positions.push_back(
            {position.x >> finer, position.y >> finer, position.z >> finer, position.depth - finer});
    }
    first.push_back(sorted.size());

    VOctree coarse;
    coarse.box_min = tree.box_min;
    coarse.box_size = tree.box_size;
    coarse.node_levels = (depth + 1) / 2;
    coarse.bases = tree.bases;
    coarse.hh_degree = tree.hh_degree;
    coarse.frames = tree.frames;
    coarse.fps = tree.fps;
    coarse.sigma_basis = tree.sigma_basis;
    coarse.gamma_basis = tree.gamma_basis;
    build_topology(coarse, coarse_positions);
    const std::vector<BasisEntry> sigma_entries = basis_entries(tree.sigma_basis, tree.bases);
    const std::vector<BasisEntry> gamma_entries = basis_entries(tree.gamma_basis, tree.bases);
    parallel_for(coarse.leaf_count, 256, [&](size_t begin, size_t end) {
        Merger merger{tree, sigma_entries, gamma_entries};
        for (size_t i = begin; i < end; i++) {
            float* sums = coarse.leaf(static_cast<uint32_t>(i));
            if (positions[sorted[first[i]].leaf].depth <= depth) {  // a leaf above the cut is copied
                std::copy_n(tree.leaf(sorted[first[i]].leaf), tree.weights_per_leaf(), sums);
                continue;
            }
            merger.clear();
            for (size_t at = first[i]; at < first[i + 1]; at++) {
                const uint32_t leaf = sorted[at].leaf, finer = positions[leaf].depth - depth;
                merger.add(tree.leaf(leaf), leaf_edge_m(tree, positions[leaf].depth),
                           std::ldexp(1.0f, -static_cast<int>(finer)), sums);
            }
            merger.divide(sums);
        }
    });
    return coarse;
}

}  // namespace

VOctree cut_tree(const VOctree& tree, uint32_t depth) {
    const std::vector<LeafPosition> positions = leaf_positions(tree);
    return cut_sorted(tree, positions, sorted_leaves(tree, positions), std::min(depth, 2 * tree.node_levels));
}

std::optional<VOctree> coarse_tree(const VOctree& tree) {
    if (tree.leaf_count < kMinLeavesForCoarse) return std::nullopt;
    const std::vector<LeafPosition> positions = leaf_positions(tree);
    const std::vector<CodedLeaf> sorted = sorted_leaves(tree, positions);
    const auto counts = leaves_of_cuts(sorted, 2 * tree.node_levels);
    uint32_t depth = 2 * tree.node_levels;
    while (depth > 1 && counts[depth] > tree.leaf_count / kMinReduction) depth--;
    VOctree coarse = cut_sorted(tree, positions, sorted, depth);
    round_weights(coarse, kRoundingError);
    return coarse;
}

}  // namespace neuvv::voctree
