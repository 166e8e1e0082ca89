// What is removed from a tree before it is written must not be visible.
#include "training/tree/compact.h"

#include <gtest/gtest.h>

#include "reference/sample.h"
#include "reference/slice.h"
#include "support/random_tree.h"
#include "training/tree/bases.h"
#include "voctree/frames.h"

namespace neuvv::test {
namespace {

voctree::VOctree tree_of(uint32_t frames, uint32_t bases, uint32_t hh_degree = 1) {
    voctree::VOctree tree = random_tree({.seed = 5, .leaves = 200, .bases = bases, .hh_degree = hh_degree});
    tree.frames = frames;
    tree.sigma_basis = tree.gamma_basis = voctree::hat_basis(frames, bases);
    return tree;
}

TEST(Compact, NoFrameShowsADifference) {
    const voctree::VOctree before = tree_of(6, 6);
    voctree::VOctree after = before;
    training::make_compact(after);
    const glm::dvec3 direction = glm::normalize(glm::dvec3(0.3, -0.5, 0.8));
    size_t live = 0;
    double largest = 0;
    for (uint32_t frame = 0; frame < before.frames; ++frame) {
        const std::vector<reference::LeafSlice> slices = reference::slice_tree(before, frame);
        const std::vector<reference::LeafSlice> compact_slices = reference::slice_tree(after, frame);
        for (uint32_t leaf = 0; leaf < before.leaf_count; ++leaf) {
            const reference::LeafSlice &was = slices[leaf], &is = compact_slices[leaf];
            EXPECT_NEAR(is.sigma, was.sigma, was.sigma / 32);
            if (was.sigma <= 0) continue;
            ++live;
            const glm::dvec3 wrong = reference::sample_colour(is, before.hh_degree, direction) -
                                     reference::sample_colour(was, before.hh_degree, direction);
            largest = std::max({largest, std::abs(wrong.x), std::abs(wrong.y), std::abs(wrong.z)});
        }
    }
    EXPECT_GT(live, 300u);
    EXPECT_LT(largest, 0.05);  // the change of a leaf's colour in linear light
    EXPECT_GT(largest, 0.0);
}

TEST(Compact, EmptyFramesAreZeroWhereEachFrameHasItsBasis) {
    voctree::VOctree tree = tree_of(6, 6);
    training::make_compact(tree);
    size_t empty = 0;
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
        for (uint32_t c = 0; c < 6; ++c) {
            EXPECT_GE(tree.leaf(leaf)[c], 0);
            if (tree.leaf(leaf)[c] > 0) continue;
            EXPECT_EQ(tree.leaf(leaf)[6 + c], 0);
            ++empty;
        }
    EXPECT_GT(empty, 100u);
}

TEST(Compact, ThinLeavesAreEmptied) {
    voctree::VOctree tree = tree_of(6, 6);
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
    const auto sigma_of = [&](uint32_t leaf, float depth) {
        return depth * std::exp2(static_cast<float>(positions[leaf].depth)) / tree.box_size.x;
    };
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
        tree.leaf(leaf)[1] = sigma_of(leaf, 0.9f * training::kThinDepth);
        tree.leaf(leaf)[2] = sigma_of(leaf, 1.1f * training::kThinDepth);
    }
    voctree::VOctree after = tree;
    training::empty_thin_leaves(after);
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
        EXPECT_EQ(after.leaf(leaf)[1], 0);
        EXPECT_EQ(after.leaf(leaf)[2], tree.leaf(leaf)[2]);
    }
    voctree::VOctree shared = tree_of(6, 5);
    const std::vector<float> weights = shared.weights;
    training::empty_thin_leaves(shared);
    EXPECT_EQ(shared.weights, weights);
}

TEST(Compact, LeavesThatAreEmptyInEveryFrameGo) {
    voctree::VOctree tree = tree_of(6, 6);
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
    const auto same_position = [](const voctree::LeafPosition& a, const voctree::LeafPosition& b) {
        return a.x == b.x && a.y == b.y && a.z == b.z && a.depth == b.depth;
    };
    for (uint32_t leaf = 0; leaf < tree.leaf_count; leaf += 3)
        for (uint32_t c = 0; c < 6; ++c) tree.leaf(leaf)[c] = -std::abs(tree.leaf(leaf)[c]);
    std::vector<uint32_t> live;
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
        if (std::any_of(tree.leaf(leaf), tree.leaf(leaf) + 6, [](float sigma) { return sigma > 0; }))
            live.push_back(leaf);
    ASSERT_GT(live.size(), tree.leaf_count / 2);
    voctree::VOctree after = tree;
    voctree::drop_empty_leaves(after);
    EXPECT_EQ(voctree::defect_of(after), "");
    ASSERT_EQ(after.leaf_count, live.size());
    const std::vector<voctree::LeafPosition> positions_after = voctree::leaf_positions(after);
    for (uint32_t leaf = 0; leaf < after.leaf_count; ++leaf) {
        EXPECT_TRUE(same_position(positions_after[leaf], positions[live[leaf]])) << leaf;
        EXPECT_TRUE(std::equal(after.leaf(leaf), after.leaf(leaf) + after.weights_per_leaf(), tree.leaf(live[leaf])));
    }

    voctree::VOctree shared = tree_of(6, 5);  // a frame between two knots has shares of both bases
    for (uint32_t leaf = 0; leaf < shared.leaf_count; ++leaf) std::fill_n(shared.leaf(leaf), 5, 1.0f);
    const uint32_t leaves = shared.leaf_count;
    shared.leaf(0)[1] = -1.0f;  // still dense in other frames
    std::fill_n(shared.leaf(1), 5, -1.0f);
    voctree::drop_empty_leaves(shared);
    EXPECT_EQ(shared.leaf_count, leaves - 1);
}

// Where frames share bases, a negative weight contributes to several frames, so it must stay.
TEST(Compact, SharedBasesKeepNegativeWeights) {
    const voctree::VOctree before = tree_of(9, 5);
    voctree::VOctree after = before;
    training::make_compact(after);
    size_t negative = 0;
    for (uint32_t leaf = 0; leaf < before.leaf_count; ++leaf)
        for (uint32_t c = 0; c < 5; ++c) {
            EXPECT_NEAR(after.leaf(leaf)[c], before.leaf(leaf)[c], std::abs(before.leaf(leaf)[c]) / 64);
            negative += before.leaf(leaf)[c] < 0 ? 1 : 0;
        }
    EXPECT_GT(negative, 100u);
}

}  // namespace
}  // namespace neuvv::test
