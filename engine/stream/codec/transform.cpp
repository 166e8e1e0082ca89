#include "stream/codec/transform.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace neuvv::stream {

namespace {

using Halves = std::array<double, 16>;  // the weights of a cell's halves

CellPairs cell_pairs_of(const Halves& weights, const Splits& splits, double unit) {
    CellPairs pairs;
    for (size_t k = 0; k < splits.count; ++k) {
        const size_t n = splits.pair[k];
        const double a = weights[2 * n], b = weights[2 * n + 1], sum = a + b;
        pairs.inverse_scale[n] = static_cast<float>(std::sqrt(sum / (a * b * unit)));
        pairs.share_b[n] = static_cast<float>(b / sum);
    }
    return pairs;
}

}  // namespace

double area_of(uint32_t depth, uint32_t finest) {
    return static_cast<double>(uint64_t{1} << 2 * (finest - depth));
}

// Weights are whole numbers, of which no sum is rounded.
Pairs::Pairs(const Octree& tree, std::span<const int32_t> factors, double unit)
    : tree_(tree), factors_(factors), unit_(unit), weights_(tree.cells.size()) {
    const auto finest = static_cast<uint32_t>(tree.cells.size());
    for (uint32_t d = finest; d-- > 0;) {
        const std::vector<Cell>& cells = tree.cells[d];
        weights_[d].resize(cells.size());
        for (size_t i = 0; i < cells.size(); ++i) {
            double sum = cells[i].children ? 0 : area_of(d, finest) * leaf_weight(cells[i].first);
            for (size_t child = 0, end = octant_count(cells[i].children); child < end; ++child)
                sum += d + 1 == finest ? leaf_weight(cells[i].first + child) : weights_[d + 1][cells[i].first + child];
            weights_[d][i] = sum;
        }
    }
}

CellPairs Pairs::of(size_t depth, const Cell& cell) const {
    const Splits& splits = kSplits[cell.children];
    const bool is_last = depth + 1 == tree_.cells.size();
    Halves halves{};
    for (size_t child = 0; child <= splits.count; ++child)
        halves[8 + splits.octant[child]] =
            is_last ? leaf_weight(cell.first + child) : weights_[depth + 1][cell.first + child];
    for (size_t n = 8; n-- > 1;) halves[n] = halves[2 * n] + halves[2 * n + 1];
    return cell_pairs_of(halves, splits, unit_);
}

Coefficients transform(const Octree& tree, const Pairs& pairs, std::span<const int32_t> factors,
                       std::span<const int16_t> leaves) {
    using Sums = std::array<double, 2>;  // of weights, of values by weight: whole numbers, so that none is rounded
    const auto finest = static_cast<uint32_t>(tree.cells.size());
    const auto of_leaf = [&](size_t leaf, double area) {
        const double weight = factors.empty() ? area : area * factors[leaf];
        return Sums{weight, weight * leaves[leaf]};
    };
    Coefficients result;
    size_t divided = tree.divided_count;
    result.values.resize(divided);
    std::unique_ptr<Sums[]> sums(new Sums[tree.most_cells()]);
    std::unique_ptr<Sums[]> below(new Sums[tree.most_cells()]);
    for (uint32_t d = finest; d-- > 0; sums.swap(below)) {
        const std::vector<Cell>& cells = tree.cells[d];
        for (size_t i = cells.size(); i-- > 0;) {
            const Cell& cell = cells[i];
            if (!cell.children) {
                sums[i] = of_leaf(cell.first, area_of(d, finest));
                continue;
            }
            const Splits& splits = kSplits[cell.children];
            std::array<Sums, 16> halves{};
            for (size_t child = 0; child <= splits.count; ++child)
                halves[8 + splits.octant[child]] =
                    d + 1 == finest ? of_leaf(cell.first + child, 1) : below[cell.first + child];
            for (size_t n = 8; n-- > 1;)
                halves[n] = {halves[2 * n][0] + halves[2 * n + 1][0], halves[2 * n][1] + halves[2 * n + 1][1]};
            const CellPairs of_cell = pairs.of(d, cell);
            --divided;
            for (size_t k = 0; k < splits.count; ++k) {
                const size_t n = splits.pair[k];
                const Sums &a = halves[2 * n], &b = halves[2 * n + 1];
                result.values[divided][n] = (b[1] / b[0] - a[1] / a[0]) / double{of_cell.inverse_scale[n]};
            }
            sums[i] = halves[1];
        }
    }
    const Sums root = below[0];
    result.root = root[1] / root[0];
    return result;
}

}  // namespace neuvv::stream
