#include "stream/transform.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace neuvv::stream {

namespace {

// Sums numbers of the leaves, of_leaf(number of the leaf, its area), over the cells of a tree, from the leaves to the
// root, and returns those of the root.
// Calls visit(number of the cell among those that are divided, its children, sums by half) for each; the last cell
// comes first. Halves without cells have 0.
template <size_t Numbers, typename OfLeaf, typename Visit>
std::array<double, Numbers> sum_up(const Octree& tree, const OfLeaf& of_leaf, const Visit& visit) {
    using Sums = std::array<double, Numbers>;
    const auto finest = static_cast<uint32_t>(tree.cells.size());
    size_t divided = tree.divided_count;
    auto sums = std::make_unique_for_overwrite<Sums[]>(tree.most_cells());
    auto below = std::make_unique_for_overwrite<Sums[]>(tree.most_cells());
    for (uint32_t d = finest; d-- > 0;) {
        const std::vector<Cell>& cells = tree.cells[d];
        const double area = area_of(d, finest);
        for (size_t i = cells.size(); i-- > 0;) {
            const Cell& cell = cells[i];
            if (!cell.children) {
                sums[i] = of_leaf(cell.first, area);
                continue;
            }
            const Splits& splits = kSplits[cell.children];
            std::array<Sums, 16> halves{};
            for (uint32_t child = 0; child <= splits.count; ++child)
                halves[8 + splits.octant[child]] =
                    d + 1 == finest ? of_leaf(cell.first + child, 1) : below[cell.first + child];
            for (size_t n = 8; n-- > 1;)
                for (size_t k = 0; k < Numbers; ++k) halves[n][k] = halves[2 * n][k] + halves[2 * n + 1][k];
            visit(--divided, cell.children, halves);
            sums[i] = halves[1];
        }
        sums.swap(below);
    }
    return below[0];
}

using Halves = std::array<std::array<double, 1>, 16>;

CellPairs cell_pairs_of(const Halves& weights, double unit) {
    CellPairs pairs;
    for (size_t n = 1; n < kPairs; ++n) {
        const double a = weights[2 * n][0], b = weights[2 * n + 1][0], sum = a + b, product = a * b;
        const bool is_pair = product > 0;
        const double scale = std::sqrt(sum / (is_pair ? product * unit : 1)), share = b / (is_pair ? sum : 1);
        pairs.inverse_scale[n] = is_pair ? static_cast<float>(scale) : 0;
        pairs.share_b[n] = is_pair ? static_cast<float>(share) : 0;
    }
    return pairs;
}

}  // namespace

double area_of(uint32_t depth, uint32_t finest) {
    return static_cast<double>(uint64_t{1} << 2 * (finest - depth));
}

Pairs pairs_of(const Octree& tree, std::span<const int16_t> factors, double unit) {
    Pairs pairs(tree.divided_count);
    sum_up<1>(
        tree, [&](uint32_t leaf, double area) { return std::array<double, 1>{area * factors[leaf]}; },
        [&](size_t cell, uint8_t, const Halves& halves) { pairs[cell] = cell_pairs_of(halves, unit); });
    return pairs;
}

// Most cells have the finest leaves alone: their pairs come from a table, by which octants are cells.
Pairs pairs_of_areas(const Octree& tree) {
    static const std::vector<CellPairs> kOfFinest = [] {
        std::vector<CellPairs> all(256);
        for (uint32_t children = 0; children < 256; ++children) {
            Halves halves{};
            for (size_t octant = 0; octant < 8; ++octant) halves[8 + octant][0] = children >> octant & 1;
            for (size_t n = 8; n-- > 1;) halves[n][0] = halves[2 * n][0] + halves[2 * n + 1][0];
            all[children] = cell_pairs_of(halves, 1);
        }
        return all;
    }();
    Pairs pairs(tree.divided_count);
    sum_up<1>(
        tree, [](uint32_t, double area) { return std::array<double, 1>{area}; },
        [&](size_t cell, uint8_t children, const Halves& halves) {
            const bool is_finest = halves[1][0] == octant_count(children);
            pairs[cell] = is_finest ? kOfFinest[children] : cell_pairs_of(halves, 1);
        });
    return pairs;
}

Coefficients transform(const Octree& tree, const Pairs& pairs, std::span<const int16_t> factors,
                       std::span<const int16_t> leaves) {
    Coefficients result;
    result.values.resize(pairs.size());
    using Sums = std::array<double, 2>;  // of weights, of values by weight: whole numbers, so that none is rounded
    const Sums root = sum_up<2>(
        tree,
        [&](uint32_t leaf, double area) {
            const double weight = factors.empty() ? area : area * factors[leaf];
            return Sums{weight, weight * leaves[leaf]};
        },
        [&](size_t cell, uint8_t, const std::array<Sums, 16>& halves) {
            for (size_t n = 1; n < kPairs; ++n) {
                const Sums &a = halves[2 * n], &b = halves[2 * n + 1];
                if (a[0] > 0 && b[0] > 0)
                    result.values[cell][n] = (b[1] / b[0] - a[1] / a[0]) / double{pairs[cell].inverse_scale[n]};
            }
        });
    result.root = root[1] / root[0];
    return result;
}

}  // namespace neuvv::stream
