#include "stream/transform.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace neuvv::stream {

namespace {

constexpr uint32_t kDepths = kMaxDepth + 1;

// Sums numbers of the leaves over the cells of a tree, from the leaves to the root, and returns those of the root.
// Before the halves of a pair are added, calls visit(number of the pair, sums of a, of b); the last pair comes first.
template <size_t Numbers, typename OfLeaf, typename Visit>
std::array<double, Numbers> sum_up(const Octree& tree, const OfLeaf& of_leaf, const Visit& visit) {
    using Sums = std::array<double, Numbers>;
    size_t pair = tree.leaf_count - 1;
    auto sums = std::make_unique_for_overwrite<Sums[]>(tree.most_cells(tree.cells.size()));
    auto below = std::make_unique_for_overwrite<Sums[]>(tree.most_cells(tree.cells.size()));
    for (size_t d = tree.cells.size(); d-- > 0;) {
        const std::vector<Cell>& cells = tree.cells[d];
        for (size_t i = cells.size(); i-- > 0;) {
            const Cell& cell = cells[i];
            if (!cell.children) {
                sums[i] = of_leaf(cell.first);
                continue;
            }
            const Splits& splits = kSplits[cell.children];
            std::array<Sums, 8> values;
            for (uint32_t child = 0; child <= splits.count; child++)
                values[splits.order[child]] = below[cell.first + child];
            for (uint32_t k = splits.count; k-- > 0;) {
                Sums& a = values[splits.from[k]];
                const Sums& b = values[k + 1];
                visit(--pair, a, b);
                for (size_t n = 0; n < Numbers; n++) a[n] += b[n];
            }
            sums[i] = values[0];
        }
        sums.swap(below);
    }
    return below[0];
}

Pair pair_of(double a, double b, double unit) {
    const double sum = a + b;
    return {static_cast<float>(std::sqrt(sum / (a * b * unit))), static_cast<float>(b / sum)};
}

}  // namespace

Pairs pairs_of(const Octree& tree, const std::vector<double>& weights, double unit) {
    Pairs pairs(tree.leaf_count - 1);
    using Sums = std::array<double, 1>;
    sum_up<1>(
        tree, [&](uint32_t leaf) { return Sums{weights[leaf]}; },
        [&](size_t pair, const Sums& a, const Sums& b) { pairs[pair] = pair_of(a[0], b[0], unit); });
    return pairs;
}

// Most cells are small: their pairs come from a table.
Pairs pairs_of_areas(const Octree& tree, const std::vector<double>& areas) {
    constexpr size_t kSmall = 32;
    static const std::vector<Pair> kPairs = [] {
        std::vector<Pair> all(kSmall * kSmall);
        for (size_t a = 1; a < kSmall; a++)
            for (size_t b = 1; b < kSmall; b++)
                all[a * kSmall + b] = pair_of(static_cast<double>(a), static_cast<double>(b), 1);
        return all;
    }();
    Pairs pairs(tree.leaf_count - 1);
    using Sums = std::array<double, 1>;
    sum_up<1>(
        tree, [&](uint32_t leaf) { return Sums{areas[leaf]}; },
        [&](size_t pair, const Sums& a, const Sums& b) {
            const bool small = a[0] < kSmall && b[0] < kSmall;
            pairs[pair] =
                small ? kPairs[static_cast<size_t>(a[0]) * kSmall + static_cast<size_t>(b[0])] : pair_of(a[0], b[0], 1);
        });
    return pairs;
}

std::vector<double> areas_of(const std::vector<Leaf>& leaves, uint32_t depth) {
    std::array<double, kDepths> of_depth;
    for (uint32_t d = 0; d <= depth; d++) of_depth[d] = std::exp2(2 * (depth - d));
    std::vector<double> areas(leaves.size());
    for (size_t i = 0; i < leaves.size(); i++) areas[i] = of_depth[leaves[i].depth];
    return areas;
}

Coefficients transform(const Octree& tree, const Pairs& pairs, const std::vector<double>& weights,
                       std::span<const int16_t> leaves) {
    Coefficients result;
    result.values.resize(pairs.size());
    using Sums = std::array<double, 2>;  // of weights, of values by weight: whole numbers, so that none is rounded
    const Sums root = sum_up<2>(
        tree,
        [&](uint32_t leaf) {
            return Sums{weights[leaf], weights[leaf] * leaves[leaf]};
        },
        [&](size_t pair, const Sums& a, const Sums& b) {
            result.values[pair] = (b[1] / b[0] - a[1] / a[0]) / double{pairs[pair].inverse_scale};
        });
    result.root = root[1] / root[0];
    return result;
}

}  // namespace neuvv::stream
