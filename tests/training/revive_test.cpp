// Holes in a surface come back to life, and nothing else does.
#include "training/revive.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "training/bases.h"

namespace neuvv::test {
namespace {

constexpr uint32_t kFrames = 40;  // more than a word of bits
constexpr float kLive = 2, kDead = -3;

// A sheet of side × side leaves of depth 3, all alive in every frame.
voctree::VOctree sheet(uint32_t side, uint32_t bases = kFrames) {
    voctree::VOctree tree;
    tree.node_levels = 2;
    tree.bases = bases;
    tree.frames = kFrames;
    tree.hh_degree = 0;
    tree.box_size = glm::vec3(2);
    tree.sigma_basis = tree.gamma_basis = training::hat_basis(kFrames, bases);
    std::vector<voctree::LeafPosition> positions;
    for (uint32_t i = 0; i < side * side; i++) positions.push_back({1 + i % side, 1 + i / side, 5, 3});
    voctree::build_topology(tree, positions);
    for (uint32_t leaf = 0; leaf < tree.leaf_count; leaf++) std::fill_n(tree.leaf(leaf), bases, kLive);
    return tree;
}

TEST(Revive, ALeafAmongLiveOnesGetsALittleDensity) {
    voctree::VOctree tree = sheet(3);
    for (const uint32_t t : {0u, 31u, 32u, 39u}) tree.leaf(4)[t] = kDead;  // the middle
    voctree::VOctree expected = tree;
    const float little = 0.2f / 0.25f;  // optical depth over the edge, 1/m
    for (const uint32_t t : {0u, 31u, 32u, 39u}) expected.leaf(4)[t] = little;
    EXPECT_EQ(training::revive_holes(tree), 4u);
    EXPECT_EQ(tree.weights, expected.weights);
    EXPECT_EQ(training::revive_holes(tree), 0u);
}

TEST(Revive, WhereFewNeighboursLiveALeafStaysDead) {
    voctree::VOctree tree = sheet(3);
    tree.leaf(0)[7] = kDead;                                          // a corner: two neighbours
    tree.leaf(1)[20] = kDead;                                         // the middle of an edge: three
    for (const uint32_t leaf : {1u, 4u}) tree.leaf(leaf)[9] = kDead;  // the middle has three others alive
    const std::vector<float> before = tree.weights;
    EXPECT_EQ(training::revive_holes(tree), 0u);
    EXPECT_EQ(tree.weights, before);
}

// What revives counts for its neighbours at the next call only; a density of exactly 0 is none.
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
    // Leaf 0 has a larger leaf above, ones of its own size to the left and below, a finer one at the middle of its
    // right face.
    voctree::build_topology(tree, {{1, 1, 1, 2}, {0, 1, 0, 1}, {0, 1, 1, 2}, {1, 0, 1, 2}, {4, 2, 2, 3}, {4, 3, 3, 3}});
    for (uint32_t leaf = 1; leaf < tree.leaf_count; leaf++) tree.leaf(leaf)[0] = kLive;
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
