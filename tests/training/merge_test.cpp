// Sibling leaves that look alike become one leaf; others do not.
#include "training/tree/merge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "support/random_tree.h"
#include "training/tree/bases.h"

namespace neuvv::test {
namespace {

constexpr uint32_t kFrames = 3;

// A tree of families of leaves at depth 3, side by side along x, the last of which lacks its last sibling, and a leaf
// of depth 1 far away. Leaf 8·f + i is sibling i of family f. All leaves of depth 3 are half opaque over an edge and
// have the same colour.
voctree::VOctree families_tree(uint32_t families) {
    voctree::VOctree tree;
    tree.node_levels = 2;
    tree.bases = tree.frames = kFrames;
    tree.hh_degree = 1;
    tree.box_size = glm::vec3(2);
    tree.sigma_basis = tree.gamma_basis = voctree::hat_basis(kFrames, kFrames);
    std::vector<voctree::LeafPosition> positions;
    for (uint32_t family = 0; family < families; ++family)
        for (uint32_t i = 0; i < 8; ++i) positions.push_back({2 * family + (i & 1), i >> 1 & 1, i >> 2, 3});
    positions.pop_back();
    positions.push_back({1, 1, 1, 1});
    voctree::build_topology(tree, positions);
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
        float* weights = tree.leaf(leaf);
        for (uint32_t c = 0; c < kFrames; ++c) {
            weights[c] = 4 * std::log(2.0f);  // as an edge is 1/4 m
            weights[kFrames + c] = 0.3f * static_cast<float>(c);
        }
        for (uint32_t w = 2 * kFrames; w < tree.weights_per_leaf(); ++w)
            weights[w] = 3 * std::cos(static_cast<float>(w));
    }
    return tree;
}

training::LeafUse use_of(const voctree::VOctree& tree) {
    training::LeafUse use;
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
        use.max_weight.push_back(0.01f * static_cast<float>(leaf + 1));
        use.opacity_sensitivity.push_back(static_cast<float>(leaf));
        use.frames.push_back(1u << leaf % kFrames);
    }
    return use;
}

uint32_t leaf_at(const voctree::VOctree& tree, voctree::LeafPosition position) {
    return voctree::find_leaf(tree, (glm::dvec3(position.x, position.y, position.z) + 0.5) / std::exp2(position.depth));
}

TEST(Merge, AWholeFamilyThatAgreesBecomesItsParent) {
    const voctree::VOctree before = families_tree(2);
    voctree::VOctree tree = before;
    tree.leaf(3)[1] *= 1.1f;  // 0.034 more opaque in frame 1
    training::LeafUse use = use_of(tree);
    EXPECT_EQ(training::merge_alike(tree, use, 0.05f), 1u);
    EXPECT_EQ(voctree::defect_of(tree), "");
    ASSERT_EQ(tree.leaf_count, before.leaf_count - 7);  // the second family is not complete, so it cannot merge
    ASSERT_EQ(use.max_weight.size(), tree.leaf_count);

    const uint32_t parent = leaf_at(tree, {0, 0, 0, 2});
    EXPECT_EQ(leaf_at(tree, {1, 1, 1, 3}), parent);
    EXPECT_FLOAT_EQ(tree.leaf(parent)[0], before.leaf(0)[0]);
    EXPECT_FLOAT_EQ(tree.leaf(parent)[1], before.leaf(0)[1] * (1 + 0.1f / 8));
    for (uint32_t w = 2; w < tree.weights_per_leaf(); ++w) EXPECT_FLOAT_EQ(tree.leaf(parent)[w], before.leaf(0)[w]);
    EXPECT_FLOAT_EQ(use.max_weight[parent], 0.08f);
    EXPECT_EQ(use.opacity_sensitivity[parent], 0);
    EXPECT_EQ(use.frames[parent], 7u);

    const uint32_t other = leaf_at(tree, {3, 1, 0, 3}), was = leaf_at(before, {3, 1, 0, 3});
    EXPECT_NE(other, UINT32_MAX);
    EXPECT_EQ(use.opacity_sensitivity[other], static_cast<float>(was));
    EXPECT_EQ(use.frames[other], 1u << was % kFrames);
    EXPECT_EQ(leaf_at(tree, {3, 1, 1, 3}), UINT32_MAX);
    EXPECT_EQ(use.opacity_sensitivity[leaf_at(tree, {1, 1, 1, 1})], static_cast<float>(before.leaf_count - 1));
}

TEST(Merge, AFamilyThatDiffersInOneFrameStays) {
    const auto merged = [](const std::function<void(float*)>& change) {
        voctree::VOctree tree = families_tree(2);
        change(tree.leaf(5));
        training::LeafUse use = use_of(tree);
        const size_t count = training::merge_alike(tree, use, 0.05f);
        EXPECT_EQ(tree.leaf_count, 16 - 7 * count);
        return count == 1;
    };
    EXPECT_TRUE(merged([](float*) {}));
    EXPECT_FALSE(merged([](float* leaf) { leaf[2] *= 1.5f; }));
    EXPECT_FALSE(merged([](float* leaf) { leaf[1] = -1; }));
    EXPECT_FALSE(merged([](float* leaf) { leaf[2 * kFrames] += 4; }));                 // red, all frames
    EXPECT_FALSE(merged([](float* leaf) { leaf[kFrames + 2] += 3; }));                 // γ of the last frame
    EXPECT_FALSE(merged([](float* leaf) { leaf[2 * kFrames + 2 * 5 + 3] += 0.7f; }));  // blue, where it is seen from
    EXPECT_TRUE(merged([](float* leaf) { leaf[2 * kFrames + 1] += 0.1f; }));
}

// Colours of transparent leaves may differ.
TEST(Merge, ClearLeavesMayDifferInColour) {
    voctree::VOctree tree = families_tree(2);
    for (uint32_t i = 0; i < 8; ++i) {
        for (uint32_t c = 0; c < kFrames; ++c) tree.leaf(i)[c] = 0.01f;
        tree.leaf(i)[2 * kFrames] = i % 2 ? 9.0f : -9.0f;
    }
    training::LeafUse use = use_of(tree);
    EXPECT_EQ(training::merge_alike(tree, use, 0.05f), 1u);
}

// In a frame that used no leaf of a family, the leaves may differ in everything; leaves that a frame did not use while
// it used others may differ in colour.
TEST(Merge, OnlyWhatFramesUsedMustAgree) {
    const auto merged = [](uint32_t frames_of_all, uint32_t frames_of_one, const std::function<void(float*)>& change) {
        voctree::VOctree tree = families_tree(2);
        change(tree.leaf(5));
        training::LeafUse use = use_of(tree);
        for (uint32_t i = 0; i < 8; ++i) use.frames[i] = i == 5 ? frames_of_one : frames_of_all;
        return training::merge_alike(tree, use, 0.05f) == 1;
    };
    const auto denser = [](float* leaf) { leaf[2] *= 1.5f; };
    EXPECT_TRUE(merged(3, 3, denser));
    EXPECT_FALSE(merged(3, 7, denser));
    EXPECT_FALSE(merged(7, 3, denser));
    const auto other_colour = [](float* leaf) { leaf[kFrames + 2] -= 6; };
    EXPECT_TRUE(merged(3, 3, other_colour));
    EXPECT_FALSE(merged(7, 7, other_colour));
    EXPECT_TRUE(merged(3, 7, other_colour));  // the only leaf that the frame used gives the parent its colour
    EXPECT_TRUE(merged(7, 3, other_colour));

    // The parent has the colour that was seen.
    voctree::VOctree tree = families_tree(2);
    other_colour(tree.leaf(5));
    training::LeafUse use = use_of(tree);
    for (uint32_t i = 0; i < 8; ++i) use.frames[i] = i == 5 ? 3 : 7;
    const float seen = tree.leaf(0)[kFrames + 2];
    ASSERT_EQ(training::merge_alike(tree, use, 0.05f), 1u);
    EXPECT_FLOAT_EQ(tree.leaf(leaf_at(tree, {0, 0, 0, 2}))[kFrames + 2], seen);
}

// Two sets of weights can give the same colours over time while their mean gives others.
TEST(Merge, WeightsThatMeanTheSameButHaveNoMeanStay) {
    voctree::VOctree tree = families_tree(2);
    for (uint32_t i = 0; i < 8; ++i)
        for (uint32_t w = kFrames; w < tree.weights_per_leaf(); ++w) {
            const uint32_t function = w < 2 * kFrames ? 0 : (w - 2 * kFrames) % 5;
            tree.leaf(i)[w] = w < 2 * kFrames ? static_cast<float>(w - kFrames) : function == 1 ? 5.0f : 0.0f;
            if (i % 2 && (w < 2 * kFrames || function == 1)) tree.leaf(i)[w] *= -1;  // π − γ, and −w_100
        }
    training::LeafUse use = use_of(tree);
    std::fill(use.frames.begin(), use.frames.end(), 7u);
    EXPECT_EQ(training::merge_alike(tree, use, 0.05f), 0u);
}

// The only leaf that was seen gives the parent its colour, whatever the colours of the hidden ones.
TEST(Merge, HiddenLeavesGiveNoColour) {
    voctree::VOctree tree = families_tree(2);
    for (uint32_t i = 0; i < 8; ++i) tree.leaf(i)[2 * kFrames] = i == 2 ? 10.0f : -10.0f;
    training::LeafUse use = use_of(tree);
    for (uint32_t i = 0; i < 8; ++i) use.frames[i] = i == 2 ? 7 : 0;
    ASSERT_EQ(training::merge_alike(tree, use, 0.05f), 1u);
    EXPECT_FLOAT_EQ(tree.leaf(leaf_at(tree, {0, 0, 0, 2}))[2 * kFrames], 10);
}

// A leaf that was used and is transparent does not merge with dense ones.
TEST(Merge, ClearAndDenseLeavesStay) {
    voctree::VOctree tree = families_tree(2);
    for (uint32_t c = 0; c < kFrames; ++c) tree.leaf(0)[c] = -1;
    training::LeafUse use = use_of(tree);
    for (uint32_t i = 0; i < 8; ++i) use.frames[i] = i == 0 ? 7 : 0;
    EXPECT_EQ(training::merge_alike(tree, use, 0.05f), 0u);
}

// There may be fewer bases than frames, and more frames than bits in a word.
TEST(Merge, ManyFramesThatShareBases) {
    constexpr uint32_t kMany = 40;
    const auto merged = [](uint32_t frame_used) {
        voctree::VOctree tree = families_tree(2);
        tree.frames = kMany;
        tree.sigma_basis = tree.gamma_basis = voctree::hat_basis(kMany, kFrames);
        for (uint32_t i = 0; i < 8; ++i) tree.leaf(i)[2] *= i == 6 ? 2.0f : 1.0f;  // the last knot: from frame 20 on
        training::LeafUse use = use_of(tree);
        use.frames.assign(size_t{2} * tree.leaf_count, 0);
        for (uint32_t i = 0; i < 8; ++i) use.frames[frame_used / 32 * tree.leaf_count + i] = 1u << frame_used % 32;
        const bool did = training::merge_alike(tree, use, 0.05f) == 1;
        EXPECT_EQ(use.frames.size(), size_t{2} * tree.leaf_count);
        if (did) {
            const uint32_t parent = leaf_at(tree, {0, 0, 0, 2});
            EXPECT_EQ(use.frames[frame_used / 32 * tree.leaf_count + parent], 1u << frame_used % 32);
        }
        return did;
    };
    EXPECT_TRUE(merged(10));
    EXPECT_FALSE(merged(39));
    EXPECT_FALSE(merged(31));
}

TEST(Merge, LeavesOfTheRootStay) {
    voctree::VOctree tree;
    tree.bases = 1;
    tree.hh_degree = 0;
    tree.sigma_basis = tree.gamma_basis = {1};
    std::vector<voctree::LeafPosition> positions;
    for (uint32_t i = 0; i < 8; ++i) positions.push_back({i & 1, i >> 1 & 1, i >> 2, 1});
    voctree::build_topology(tree, positions);
    training::LeafUse use{std::vector<float>(8), std::vector<float>(8), std::vector<uint32_t>(8)};
    EXPECT_EQ(training::merge_alike(tree, use, 1), 0u);
    EXPECT_EQ(tree.leaf_count, 8u);
}

}  // namespace
}  // namespace neuvv::test
