#include "stream/transform.h"

#include <algorithm>
#include <array>
#include <bit>
#include <memory>

namespace neuvv::stream {

namespace {

// Numbers of the octants of a cell, or of groups of them, by their first octant.
using Octants = std::array<double, 8>;

// Reads what the children of a cell have.
Octants octants_of(const Cell& cell, const std::vector<double>& below) {
    Octants octants{};
    uint32_t next = cell.first;
    for (uint32_t octant = 0; octant < 8; octant++)
        if (cell.children >> octant & 1) octants[octant] = below[next++];
    return octants;
}

// Sums of weights: of each depth, of each cell.
std::vector<std::vector<double>> sums_of(const Octree& tree, const std::vector<double>& weights) {
    std::vector<std::vector<double>> sums(tree.cells.size());
    for (size_t d = tree.cells.size(); d-- > 0;) {
        sums[d].resize(tree.cells[d].size());
        for (size_t i = 0; i < tree.cells[d].size(); i++) {
            const Cell& cell = tree.cells[d][i];
            if (!cell.children) {
                sums[d][i] = weights[cell.first];
                continue;
            }
            for (uint32_t c = 0; c < octant_count(cell.children); c++) sums[d][i] += sums[d + 1][cell.first + c];
        }
    }
    return sums;
}

// The sums of each group of octants, for those groups that for_pairs splits.
struct Groups {
    std::array<std::array<double, 8>, 3> sums;  // by the number of octants in a group: 1, 2, 4 as 0, 1, 2
    explicit Groups(const Octants& octants) {
        sums[0] = octants;
        for (uint32_t level = 1; level < 3; level++)
            for (uint32_t i = 0; i < 8; i += 2u << (level - 1))
                sums[level][i] = sums[level - 1][i] + sums[level - 1][i + (1u << (level - 1))];
    }
    double of(uint32_t i, uint32_t s) const { return sums[static_cast<size_t>(std::countr_zero(s))][i]; }
};

}  // namespace

Pairs pairs_of(const Octree& tree, const std::vector<double>& weights, double unit) {
    const std::vector<std::vector<double>> sums = sums_of(tree, weights);
    Pairs all;
    all.reserve(tree.leaf_count);
    for (size_t d = 0; d + 1 < tree.cells.size(); d++) {
        for (const Cell& cell : tree.cells[d]) {
            if (octant_count(cell.children) < 2) continue;
            const Groups groups(octants_of(cell, sums[d + 1]));
            for_pairs(
                cell.children,
                [&](uint32_t i, uint32_t s) {
                    const double a = groups.of(i, s), b = groups.of(i + s, s);
                    all.push_back(
                        {static_cast<float>(std::sqrt((a + b) / (a * b * unit))), static_cast<float>(b / (a + b))});
                },
                [](uint32_t, uint32_t) {});
        }
    }
    return all;
}

std::vector<double> areas_of(const std::vector<Leaf>& leaves, uint32_t depth) {
    std::vector<double> areas;
    areas.reserve(leaves.size());
    for (const Leaf& leaf : leaves) areas.push_back(std::exp2(2 * (depth - leaf.depth)));
    return areas;
}

Coefficients transform(const Octree& tree, const Pairs& pairs, const std::vector<double>& weights,
                       std::span<const int16_t> leaves) {
    Coefficients result;
    if (tree.leaf_count == 0) return result;
    const std::vector<std::vector<double>> sums = sums_of(tree, weights);
    std::vector<std::vector<double>> means(tree.cells.size());
    for (size_t d = tree.cells.size(); d-- > 0;) {
        means[d].resize(tree.cells[d].size());
        for (size_t i = 0; i < tree.cells[d].size(); i++) {
            const Cell& cell = tree.cells[d][i];
            if (!cell.children) {
                means[d][i] = leaves[cell.first];
                continue;
            }
            for (uint32_t c = 0; c < octant_count(cell.children); c++) {
                const size_t child = cell.first + size_t{c};
                means[d][i] += sums[d + 1][child] / sums[d][i] * means[d + 1][child];
            }
        }
    }
    result.root = means[0][0];
    result.values.reserve(pairs.size());
    for (size_t d = 0; d + 1 < tree.cells.size(); d++)
        for (const Cell& cell : tree.cells[d]) {
            if (octant_count(cell.children) < 2) continue;
            const Octants weight = octants_of(cell, sums[d + 1]);
            Octants product = octants_of(cell, means[d + 1]);
            for (uint32_t octant = 0; octant < 8; octant++) product[octant] *= weight[octant];
            const Groups of_weights(weight), of_products(product);
            for_pairs(
                cell.children,
                [&](uint32_t i, uint32_t s) {
                    const double a = of_products.of(i, s) / of_weights.of(i, s);
                    const double b = of_products.of(i + s, s) / of_weights.of(i + s, s);
                    result.values.push_back((b - a) / double{pairs[result.values.size()].inverse_scale});
                },
                [](uint32_t, uint32_t) {});
        }
    return result;
}

namespace {

// Inverts some of the planes, from `first` on. Their number is known to the compiler, so that it can do several at
// once.
template <size_t Planes>
void invert_planes(const Octree& tree, const Pairs& pairs, std::span<const float> roots, std::span<const float> steps,
                   const Numbers& numbers, size_t first, std::vector<std::vector<float>>& leaves) {
    using Values = std::array<float, Planes>;
    Values root, step;
    for (size_t p = 0; p < Planes; p++) {
        root[p] = roots[first + p];
        step[p] = steps[first + p];
    }
    size_t most = 0;  // cells of a depth
    for (const std::vector<Cell>& cells : tree.cells) most = std::max(most, cells.size());
    auto values = std::make_unique_for_overwrite<Values[]>(most),
         below = std::make_unique_for_overwrite<Values[]>(most);
    values[0] = root;
    const int16_t* next_number = numbers.numbers.data() + first;
    const Pair* next_pair = pairs.data();
    for (size_t d = 0; d < tree.cells.size(); d++) {
        for (size_t i = 0; i < tree.cells[d].size(); i++) {
            const Cell& cell = tree.cells[d][i];
            if (!cell.children) {
                for (size_t p = 0; p < Planes; p++) leaves[first + p][cell.first] = values[i][p];
                continue;
            }
            std::array<Values, 8> octants;
            octants[0] = values[i];
            for_pairs(
                cell.children,
                [&](uint32_t at, uint32_t s) {
                    Values& a = octants[at];
                    Values& b = octants[at + s];
                    for (size_t p = 0; p < Planes; p++) {
                        const float apart = static_cast<float>(next_number[p]) * step[p] * next_pair->inverse_scale;
                        a[p] = a[p] - next_pair->share_b * apart;
                        b[p] = a[p] + apart;
                    }
                    next_pair++;
                    next_number += numbers.planes;
                },
                [&](uint32_t at, uint32_t s) { octants[at + s] = octants[at]; });
            Values* to = &below[cell.first];
            for (uint32_t octant = 0; octant < 8; octant++)
                if (cell.children >> octant & 1) *to++ = octants[octant];
        }
        values.swap(below);
    }
}

}  // namespace

std::vector<std::vector<float>> inverse_transform(const Octree& tree, const Pairs& pairs, std::span<const float> roots,
                                                  std::span<const float> steps, const Numbers& numbers) {
    std::vector<std::vector<float>> leaves(roots.size());
    for (std::vector<float>& plane : leaves) plane.resize(tree.leaf_count);
    if (tree.leaf_count == 0) return leaves;
    for (size_t first = 0; first < roots.size();) {
        const size_t rest = roots.size() - first;
        const auto invert = rest >= 12 ? invert_planes<12> : rest >= 3 ? invert_planes<3> : invert_planes<1>;
        invert(tree, pairs, roots, steps, numbers, first, leaves);
        first += rest >= 12 ? 12 : rest >= 3 ? 3 : 1;
    }
    return leaves;
}

}  // namespace neuvv::stream
