// Leaves that are holes in a surface get density again; other leaves do not.
#include "training/tree/revive.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "training/tree/bases.h"

namespace neuvv::test {
namespace {

constexpr uint32_t kRevivedFrames = 40;  // more than a word of bits
constexpr float kLive = 2, kDead = -3;

// A tree that is a sheet of side × side leaves of depth 3, all of which have density in every frame.
voctree::VOctree sheet(uint32_t side, uint32_t bases = kRevivedFrames) {
    voctree::VOctree tree;
    tree.node_levels = 2;
    tree.bases = bases;
    tree.frames = kRevivedFrames;
    tree.hh_degree = 0;
    tree.box_size = glm::vec3(2);
    tree.sigma_basis = tree.gamma_basis = voctree::hat_basis(kRevivedFrames, bases);
    std::vector<voctree::LeafPosition> positions;
    for (uint32_t i = 0; i < side * side; ++i) positions.push_back({1 + i % side, 1 + i / side, 5, 3});
    voctree::build_topology(tree, positions);
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) std::fill_n(tree.leaf(leaf), bases, kLive);
    return tree;
}

TEST(Revive, ALeafAmongLiveOnesGetsALittleDensity) {
    voctree::VOctree tree = sheet(3);
    for (const uint32_t t : {0u, 31u, 32u, 39u}) tree.leaf(4)[t] = kDead;  // the leaf in the middle
    voctree::VOctree expected = tree;
    const float little = 0.2f / 0.25f;  // 1/m: an optical depth of 0.2 over an edge of 0.25 m
    for (const uint32_t t : {0u, 31u, 32u, 39u}) expected.leaf(4)[t] = little;
    EXPECT_EQ(training::revive_holes(tree), 4u);
    EXPECT_EQ(tree.weights, expected.weights);
    EXPECT_EQ(training::revive_holes(tree), 0u);
}

TEST(Revive, WhereFewNeighboursLiveALeafStaysDead) {
    voctree::VOctree tree = sheet(3);
    tree.leaf(0)[7] = kDead;   // a corner: two neighbours
    tree.leaf(1)[20] = kDead;  // the middle of an edge: three
    for (const uint32_t leaf : {1u, 4u})
        tree.leaf(leaf)[9] = kDead;  // leaf 4, in the middle, has three live neighbours
    const std::vector<float> before = tree.weights;
    EXPECT_EQ(training::revive_holes(tree), 0u);
    EXPECT_EQ(tree.weights, before);
}

// A leaf that is revived counts as a live neighbour only in the next call. A density of exactly 0 counts as none.
TEST(Revive, LeavesThatReviveDoNotReviveOthers) {
    voctree::VOctree tree = sheet(4);
    tree.leaf(5)[3] = 0;      // inside: its neighbours 1, 4, 9 live, 6 does not
    tree.leaf(6)[3] = kDead;  // inside: 2, 7, 10 live, 5 does not
    EXPECT_EQ(training::revive_holes(tree), 0u);
    tree.leaf(6)[3] = kLive;
    EXPECT_EQ(training::revive_holes(tree), 1u);
    EXPECT_GT(tree.leaf(5)[3], 0);
}

TEST(Revive, ALargerLeafIsANeighbourOfSmallerOnes) {
    voctree::VOctree tree;
    tree.node_levels = 2;
    tree.bases = tree.frames = 1;
    tree.hh_degree = 0;
    tree.sigma_basis = tree.gamma_basis = {1};
    // Leaf 0 has a larger leaf above it, leaves of its size to the left and below, and a finer one at the middle of its
    // right face.
    voctree::build_topology(tree, {{1, 1, 1, 2}, {0, 1, 0, 1}, {0, 1, 1, 2}, {1, 0, 1, 2}, {4, 2, 2, 3}, {4, 3, 3, 3}});
    for (uint32_t leaf = 1; leaf < tree.leaf_count; ++leaf) tree.leaf(leaf)[0] = kLive;
    tree.leaf(0)[0] = kDead;
    EXPECT_EQ(training::revive_holes(tree), 1u);
    EXPECT_FLOAT_EQ(tree.leaf(0)[0], 0.2f / 0.25f);
}

TEST(Revive, FramesThatShareBasesStay) {
    voctree::VOctree tree = sheet(3, 5);
    tree.leaf(4)[2] = kDead;
    const std::vector<float> before = tree.weights;
    EXPECT_EQ(training::revive_holes(tree), 0u);
    EXPECT_EQ(tree.weights, before);
}

}  // namespace
}  // namespace neuvv::test
