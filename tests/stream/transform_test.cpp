// The octree of a slice and the transform of its planes.
#include "stream/codec/transform.h"
#include "stream/codec/planes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "stream/random_slice.h"

namespace neuvv::test::transform_test {
namespace {

struct Coordinates {
    int64_t x, y, z;
};
Coordinates coordinates_of(uint64_t code) {
    const voctree::LeafPosition at = voctree::position_of(code, 0);
    return {at.x, at.y, at.z};
}

TEST(StreamOctree, HasTheLeavesInOrder) {
    for (const uint32_t depth : {2u, 4u, 6u, 8u}) {
        const stream::QuantisedSlice slice = random_slice(depth, depth, 300, 0);
        const stream::Octree tree = stream::octree_of(slice.leaves, depth);
        EXPECT_EQ(tree.leaf_count, slice.leaves.size());
        EXPECT_EQ(stream::leaves_of(tree, depth), slice.leaves);
    }
    EXPECT_EQ(stream::octree_of({}, 4).leaf_count, 0u);
}

TEST(StreamOctree, KnowsFaceNeighbours) {
    const uint32_t depth = 6;
    const stream::QuantisedSlice slice = random_slice(9, depth, 400, 0);
    const stream::Octree tree = stream::octree_of(slice.leaves, depth);
    stream::Surroundings beside = stream::surroundings_of_root();
    size_t found = 0;
    for (uint32_t d = 0; d < depth; ++d) {
        const std::vector<stream::Cell>& all = tree.cells[d];
        std::map<std::array<int64_t, 3>, uint32_t> cells;
        std::vector<uint8_t> is_leaf;
        size_t divided = 0;
        for (uint32_t i = 0; i < all.size(); ++i) {
            const Coordinates at = coordinates_of(all[i].code);
            cells[{at.x, at.y, at.z}] = i;
            is_leaf.push_back(all[i].children == 0);
        }
        if (d > 0) beside = stream::surroundings_below(tree.cells[d - 1], beside, is_leaf, true);
        for (const stream::Cell& one : all) {
            if (!one.children) continue;
            ASSERT_LT(divided, beside.neighbours.size());
            for (size_t side = 0; side < 6; ++side) {
                const Coordinates at = coordinates_of(one.code);
                std::array<int64_t, 3> next = {at.x, at.y, at.z};
                next[side / 2] += side % 2 ? 1 : -1;
                const auto cell = cells.find(next);
                EXPECT_EQ(beside.neighbours[divided][side], cell == cells.end() ? stream::kNone : cell->second);
                EXPECT_EQ(beside.patterns[divided] >> side & 1, cell == cells.end() ? 0 : 1) << d << ' ' << divided;
                found += cell != cells.end();
            }
            ++divided;
        }
        EXPECT_EQ(beside.neighbours.size(), divided);
        EXPECT_EQ(beside.patterns.size(), divided);
    }
    EXPECT_GT(found, 100u);
}

size_t count_pairs(const stream::Octree& tree, const stream::Pairs& pairs) {
    size_t count = 0;
    for (size_t depth = 0; depth < tree.cells.size(); ++depth)
        for (const stream::Cell& cell : tree.cells[depth])
            if (cell.children)
                count += static_cast<size_t>(
                    std::ranges::count_if(pairs.of(depth, cell).inverse_scale, [](float scale) { return scale > 0; }));
    return count;
}

std::vector<double> areas_of(const stream::QuantisedSlice& slice) {
    std::vector<double> areas;
    for (const stream::Leaf& leaf : slice.leaves) areas.push_back(std::exp2(2 * (slice.depth - leaf.depth)));
    return areas;
}

// An orthonormal transform: the weighted squares of what values have beyond their mean are those of the coefficients.
TEST(StreamTransform, KeepsSquares) {
    const stream::QuantisedSlice slice = random_slice(2, 6, 500, 0);
    const stream::Octree tree = stream::octree_of(slice.leaves, slice.depth);
    std::vector<double> weights = areas_of(slice);
    std::vector<int32_t> factors;
    for (size_t i = 0; i < weights.size(); ++i) {
        factors.push_back(static_cast<int32_t>(1 + i % 5));
        weights[i] *= factors[i];
    }
    const stream::Pairs pairs(tree, factors, 0.25);
    EXPECT_EQ(count_pairs(tree, pairs) + 1, slice.leaves.size());
    const stream::Coefficients all = stream::transform(tree, pairs, factors, slice.planes[1]);
    double mean = 0, sum = 0, squares = 0, of_coefficients = 0;
    for (size_t i = 0; i < weights.size(); ++i) {
        mean += weights[i] * slice.planes[1][i];
        sum += weights[i];
    }
    mean /= sum;
    EXPECT_NEAR(all.root, mean, 1e-9);
    for (size_t i = 0; i < weights.size(); ++i)
        squares += 0.25 * weights[i] * (slice.planes[1][i] - mean) * (slice.planes[1][i] - mean);
    for (const auto& cell : all.values)
        for (const double value : cell) of_coefficients += value * value;
    EXPECT_NEAR(of_coefficients / squares, 1, 1e-6);
}

TEST(StreamTransform, ComesBackWithinTheSteps) {
    const stream::QuantisedSlice slice = random_slice(4, 8, 700, 3);
    const stream::Octree tree = stream::octree_of(slice.leaves, slice.depth);
    const std::vector<double> weights = areas_of(slice);
    const stream::Pairs pairs(tree);
    const size_t planes = slice.planes.size();
    std::vector<std::vector<std::array<int16_t, stream::kPairs>>> numbers(planes);
    std::vector<std::vector<int16_t>> back(planes, std::vector<int16_t>(slice.leaves.size()));
    std::vector<stream::PlaneOfTree> given;
    for (uint32_t p = 0; p < planes; ++p) {
        const stream::Coefficients all = stream::transform(tree, pairs, {}, slice.planes[p]);
        for (const auto& cell : all.values)
            std::ranges::transform(cell, numbers[p].emplace_back().begin(),
                                   [](double value) { return static_cast<int16_t>(std::lround(value / 16)); });
        given.push_back({p, static_cast<float>(all.root), 16, numbers[p], back[p]});
    }
    std::vector<stream::SymbolWriter> coarse(planes), fine(planes);
    stream::code_planes<stream::SymbolWriter>(coarse, fine, tree, pairs, slice.depth, given);
    double squares = 0;
    for (uint32_t p = 0; p < planes; ++p)
        for (size_t i = 0; i < back[p].size(); ++i) {
            const double error = back[p][i] - slice.planes[p][i];
            EXPECT_LT(std::abs(error), 48);
            squares += weights[i] * error * error;
        }
    // Each coefficient is off by up to a half of its step: 16² / 12 in the mean.
    EXPECT_NEAR(squares / static_cast<double>(planes * count_pairs(tree, pairs)), 256.0 / 12, 1);
}

}  // namespace
}  // namespace neuvv::test::transform_test
