#include "slice/coarser.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/sigmoid.h"
#include "base/threads/parallel.h"

namespace neuvv::slice {

namespace {

constexpr size_t kGroupsOfPart = 4096;
// So that leaves that are not shown have a mean colour, and are told apart by how well they agree.
constexpr float kLeastShown_m2 = 1e-12f;
constexpr float kLeastDivisor = 1e-6f;

// The leaves of one cell of the octree that could become one leaf.
struct Siblings {
    size_t first = 0, count = 0;  // in the slice's leaves
    float cost = 0;               // by how much images may change
};

// Each group of leaves that fill a part of the same parent, at a depth, if nothing in the parent is finer.
std::vector<Siblings> siblings_at(const Slice& slice, uint32_t depth) {
    std::vector<Siblings> all;
    const auto parent = [&](size_t i) { return slice.leaves[i].cell >> 3 * (slice.depth - depth + 1); };
    for (size_t i = 0; i < slice.leaves.size();) {
        size_t end = i + 1;
        bool alike = slice.leaves[i].depth == depth;
        while (end < slice.leaves.size() && parent(end) == parent(i)) alike &= slice.leaves[end++].depth == depth;
        if (alike) all.push_back({i, end - i, 0});
        i = end;
    }
    return all;
}

// The leaf in place of siblings: the mean density of their parent, and colours weighted by how much each leaf is shown.
Leaf merged(const Slice& slice, const Siblings& siblings) {
    Leaf sum = slice.leaves[siblings.first];
    --sum.depth;
    sum.sigma = 0;
    sum.shown = 0;
    sum.colours = {};
    float weights = 0;
    for (size_t i = siblings.first; i < siblings.first + siblings.count; ++i) {
        const Leaf& leaf = slice.leaves[i];
        const float weight = leaf.shown + kLeastShown_m2;
        weights += weight;
        sum.shown += leaf.shown;
        sum.sigma += leaf.sigma / 8;
        for (size_t c = 0; c < 3; ++c)
            for (size_t k = 0; k < leaf.colours[c].size(); ++k) sum.colours[c][k] += weight * leaf.colours[c][k];
    }
    for (auto& channel : sum.colours)
        for (float& k : channel) k /= weights;
    const uint32_t shift = 3 * (slice.depth - sum.depth);
    sum.cell = sum.cell >> shift << shift;
    return sum;
}

// How far opacity and colour of the cells are from the merged leaf's, each by how much of it is shown; an empty cell is
// shown as much as the others in the mean.
float cost_of(const Slice& slice, const Siblings& siblings) {
    const Leaf whole = merged(slice, siblings);
    const float edge = slice.edge_m(whole) / 2;
    const float opacity = -std::expm1(-whole.sigma * edge);
    std::array<float, 3> colour;
    for (size_t c = 0; c < 3; ++c) colour[c] = sigmoid(whole.colours[c][0] * kMeanHarmonic);
    float cost = static_cast<float>(8 - siblings.count) * opacity * whole.shown / static_cast<float>(siblings.count);
    for (size_t i = siblings.first; i < siblings.first + siblings.count; ++i) {
        const Leaf& leaf = slice.leaves[i];
        const float own = -std::expm1(-leaf.sigma * edge);
        float difference = std::abs(own - opacity) / std::max(own, kLeastDivisor);
        for (size_t c = 0; c < 3; ++c) difference += std::abs(sigmoid(leaf.colours[c][0] * kMeanHarmonic) - colour[c]);
        cost += difference * (leaf.shown + kLeastShown_m2);
    }
    return cost;
}

// One leaf in place of each group of `chosen`, which are in the order of their leaves.
void merge(Slice& slice, const std::vector<Siblings>& chosen) {
    std::vector<Leaf> leaves;
    leaves.reserve(slice.leaves.size());
    auto next = slice.leaves.begin();
    for (const Siblings& siblings : chosen) {
        const auto first = slice.leaves.begin() + static_cast<std::ptrdiff_t>(siblings.first);
        leaves.insert(leaves.end(), next, first);
        leaves.push_back(merged(slice, siblings));
        next = first + static_cast<std::ptrdiff_t>(siblings.count);
    }
    leaves.insert(leaves.end(), next, slice.leaves.end());
    slice.leaves = std::move(leaves);
}

}  // namespace

Slice with_fewer_leaves(Slice slice, size_t most_leaves) {
    for (uint32_t depth = slice.depth; depth > 1 && slice.leaves.size() > most_leaves; --depth) {
        std::vector<Siblings> all = siblings_at(slice, depth);
        parallel_for(all.size(), kGroupsOfPart, [&](size_t begin, size_t end) {
            for (size_t i = begin; i < end; ++i) all[i].cost = cost_of(slice, all[i]);
        });
        std::sort(all.begin(), all.end(), [](const Siblings& a, const Siblings& b) {
            return std::pair(a.cost, a.first) < std::pair(b.cost, b.first);
        });
        size_t left = slice.leaves.size(), chosen = 0;
        while (chosen < all.size() && left > most_leaves) left -= all[chosen++].count - 1;
        all.resize(chosen);
        std::sort(all.begin(), all.end(), [](const Siblings& a, const Siblings& b) { return a.first < b.first; });
        merge(slice, all);
    }
    return slice;
}

Slice with_depth(Slice slice, uint32_t most_depth) {
    for (; slice.depth > std::max(most_depth, 1u); --slice.depth) {
        merge(slice, siblings_at(slice, slice.depth));
        for (Leaf& leaf : slice.leaves) leaf.cell >>= 3;
    }
    return slice;
}

}  // namespace neuvv::slice
