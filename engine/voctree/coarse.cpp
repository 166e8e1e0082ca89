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

constexpr uint32_t kShare = 32;        // leaves for one of the coarse tree, at least
constexpr float kRounding = 1 / 8.0f;  // of what a coarse leaf shows; merging has cost more

struct SortedLeaf {
    uint64_t code;
    uint32_t leaf;
};

std::vector<SortedLeaf> sorted_leaves(const VOctree& tree, const std::vector<LeafPosition>& places) {
    std::vector<SortedLeaf> sorted(places.size());
    for (uint32_t i = 0; i < places.size(); i++) sorted[i] = {first_cell(places[i], 2 * tree.node_levels), i};
    const auto before = [](const SortedLeaf& a, const SortedLeaf& b) { return a.code < b.code; };
    if (!std::is_sorted(sorted.begin(), sorted.end(), before)) std::sort(sorted.begin(), sorted.end(), before);
    return sorted;
}

// How many leaves a cut at each depth leaves: neighbours stay apart from the depth on at which their codes differ.
std::array<size_t, 2 * kMaxNodeLevels + 1> leaves_of_cuts(const std::vector<SortedLeaf>& sorted, uint32_t finest) {
    std::array<size_t, 2 * kMaxNodeLevels + 1> counts{};
    for (size_t i = 1; i < sorted.size(); i++) {
        const auto digits = static_cast<uint32_t>(std::bit_width(sorted[i].code ^ sorted[i - 1].code) + 2) / 3;
        counts[finest - digits + 1]++;
    }
    counts[0]++;
    for (size_t depth = 1; depth <= finest; depth++) counts[depth] += counts[depth - 1];
    return counts;
}

// Bases that no frame mixes with others: below 0 they are as empty as at 0, and count so in a mean.
std::vector<bool> lone_bases(const VOctree& tree, const std::vector<BasisEntry>& entries) {
    std::vector<uint32_t> in_frame(tree.frames);
    for (const BasisEntry& entry : entries) in_frame[entry.frame]++;
    std::vector<bool> lone(tree.bases, true);
    for (const BasisEntry& entry : entries)
        if (in_frame[entry.frame] > 1 || entry.value < 0) lone[entry.basis] = false;
    return lone;
}

// Gathers the leaves of one cell.
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

    // `edge`: of the leaf, as a share of the cell's.
    void add(const float* leaf, float edge_m, float edge, float* sums) {
        density_of_frames(leaf, sigma_entries, sigma);
        float shown = 0;  // as much as the leaf covers
        for (uint32_t t = 0; t < tree.frames; t++)
            shown += opacity[t] = edge * edge * (1 - std::exp(-sigma[t] * edge_m));
        std::fill(share.begin(), share.end(), 0.0f);
        for (const BasisEntry& entry : gamma_entries)
            share[entry.basis] += std::abs(entry.value) * opacity[entry.frame];
        for (uint32_t c = 0; c < tree.bases; c++) {
            sums[c] += edge * edge * edge * (lone[c] ? std::max(leaf[c], 0.0f) : leaf[c]);
            sums[tree.bases + c] += share[c] * leaf[tree.bases + c];
            share_sum[c] += share[c];
        }
        for (uint32_t w = 2 * tree.bases; w < tree.weights_per_leaf(); w++) sums[w] += shown * leaf[w];
        colour_sum += shown;
    }

    // What shows nowhere is 0.
    void divide(float* sums) const {
        for (uint32_t c = 0; c < tree.bases; c++)
            if (share_sum[c] > 0) sums[tree.bases + c] /= share_sum[c];
        for (uint32_t w = 2 * tree.bases; w < tree.weights_per_leaf(); w++)
            if (colour_sum > 0) sums[w] /= colour_sum;
    }
};

VOctree cut_sorted(const VOctree& tree, const std::vector<LeafPosition>& places, const std::vector<SortedLeaf>& sorted,
                   uint32_t depth) {
    const uint32_t below = 3 * (2 * tree.node_levels - depth);
    std::vector<size_t> first;  // of each coarse leaf's in `sorted`, and the end
    std::vector<LeafPosition> coarse_places;
    for (size_t i = 0; i < sorted.size(); i++) {
        if (i > 0 && sorted[i].code >> below == sorted[i - 1].code >> below) continue;
        first.push_back(i);
        const LeafPosition& place = places[sorted[i].leaf];
        const uint32_t finer = place.depth - std::min(place.depth, depth);
        coarse_places.push_back({place.x >> finer, place.y >> finer, place.z >> finer, place.depth - finer});
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
    build_topology(coarse, coarse_places);
    const std::vector<BasisEntry> sigma_entries = basis_entries(tree.sigma_basis, tree.bases);
    const std::vector<BasisEntry> gamma_entries = basis_entries(tree.gamma_basis, tree.bases);
    parallel_for(coarse.leaf_count, 256, [&](size_t begin, size_t end) {
        Merger merger{tree, sigma_entries, gamma_entries};
        for (size_t i = begin; i < end; i++) {
            float* sums = coarse.leaf(static_cast<uint32_t>(i));
            if (places[sorted[first[i]].leaf].depth <= depth) {  // alone, and no larger than before
                std::copy_n(tree.leaf(sorted[first[i]].leaf), tree.weights_per_leaf(), sums);
                continue;
            }
            merger.clear();
            for (size_t at = first[i]; at < first[i + 1]; at++) {
                const uint32_t leaf = sorted[at].leaf, finer = places[leaf].depth - depth;
                merger.add(tree.leaf(leaf), leaf_edge_m(tree, places[leaf].depth),
                           std::ldexp(1.0f, -static_cast<int>(finer)), sums);
            }
            merger.divide(sums);
        }
    });
    return coarse;
}

}  // namespace

VOctree cut_tree(const VOctree& tree, uint32_t depth) {
    const std::vector<LeafPosition> places = leaf_positions(tree);
    return cut_sorted(tree, places, sorted_leaves(tree, places), std::min(depth, 2 * tree.node_levels));
}

std::optional<VOctree> coarse_tree(const VOctree& tree) {
    if (tree.leaf_count < kCoarseFrom) return std::nullopt;
    const std::vector<LeafPosition> places = leaf_positions(tree);
    const std::vector<SortedLeaf> sorted = sorted_leaves(tree, places);
    const auto counts = leaves_of_cuts(sorted, 2 * tree.node_levels);
    uint32_t depth = 2 * tree.node_levels;
    while (depth > 1 && counts[depth] > tree.leaf_count / kShare) depth--;
    VOctree coarse = cut_sorted(tree, places, sorted, depth);
    round_weights(coarse, kRounding);
    return coarse;
}

}  // namespace neuvv::voctree
