// Slices of trees against the reference's slice.
#include "voctree/tree_slice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "reference/slice.h"
#include "support/random_tree.h"

namespace neuvv::test {
namespace {

voctree::VOctree some_tree() {
    return random_tree({.node_levels = 3, .leaves = 400, .bases = 5, .hh_degree = 2});
}

// By first cell and depth.
std::map<std::pair<uint64_t, uint32_t>, slice::Leaf> by_cell(const slice::Slice& slice) {
    std::map<std::pair<uint64_t, uint32_t>, slice::Leaf> leaves;
    for (const slice::Leaf& leaf : slice.leaves) leaves[{leaf.cell, leaf.depth}] = leaf;
    return leaves;
}

void expect_live_leaves(const voctree::VOctree& tree, double frame) {
    const slice::Slice slice = voctree::slice_of(tree, frame);
    const auto leaves = by_cell(slice);
    const auto truth = reference::slice_tree(tree, frame);
    const auto positions = voctree::leaf_positions(tree);
    size_t live = 0;
    for (size_t i = 0; i < truth.size(); ++i) {
        const voctree::LeafPosition& at = positions[i];
        const auto found = leaves.find({voctree::first_cell(at, slice.depth), at.depth});
        const double edge = double{tree.box_size.x + tree.box_size.y + tree.box_size.z} / 3 / (1u << at.depth);
        if (1 - std::exp(-truth[i].sigma * edge) < double{slice::kLeastOpacity}) {
            EXPECT_EQ(found, leaves.end());
            continue;
        }
        ++live;
        ASSERT_NE(found, leaves.end());
        EXPECT_NEAR(double{found->second.sigma}, truth[i].sigma, 1e-4 * truth[i].sigma);
        for (size_t c = 0; c < 3; ++c)
            for (size_t k = 0; k < 9; ++k) EXPECT_NEAR(double{found->second.colours[c][k]}, truth[i].k[c][k], 1e-4);
        const glm::dvec3 centre = (glm::dvec3(at.x, at.y, at.z) + 0.5) / double(1u << at.depth);
        const glm::dvec3 world = glm::dvec3(tree.box_min) + glm::dvec3(tree.box_size) * centre;
        EXPECT_LT(glm::distance(world, glm::dvec3(slice.centre_m(found->second))), 1e-6);
    }
    EXPECT_EQ(live, slice.leaves.size());
    EXPECT_GT(live, 100u);
}

TEST(TreeSlice, HasTheLiveLeaves) {
    expect_live_leaves(some_tree(), 3);
}

TEST(TreeSlice, MixesFramesBetweenTwo) {
    expect_live_leaves(some_tree(), 2.25);
}

TEST(TreeSlice, IsTheSliceThatATreeOfItHas) {
    const slice::Slice slice = voctree::slice_of(some_tree(), 1.5);
    EXPECT_EQ(slice::defect_of(slice), "");
    const slice::Slice again = voctree::slice_of(voctree::tree_of(slice, 25), 0);
    ASSERT_EQ(again.leaves.size(), slice.leaves.size());
    for (size_t i = 0; i < slice.leaves.size(); ++i) {
        EXPECT_EQ(again.leaves[i].cell, slice.leaves[i].cell);
        EXPECT_EQ(again.leaves[i].depth, slice.leaves[i].depth);
        EXPECT_EQ(again.leaves[i].sigma, slice.leaves[i].sigma);
        for (size_t c = 0; c < 3; ++c)
            for (size_t k = 0; k < 9; ++k)
                EXPECT_NEAR(double{again.leaves[i].colours[c][k]}, double{slice.leaves[i].colours[c][k]}, 1e-5);
    }
}

}  // namespace
}  // namespace neuvv::test
