// The box of what is solid: the whole body at its time, and no floaters.
#include "voctree/files/solid_leaves.h"

#include <gtest/gtest.h>

#include "support/figure.h"
#include "voctree/files/occupied_box.h"
#include "voctree/tree_slice.h"

namespace neuvv::test {
namespace {

constexpr double kCell = 1.0 / kFigureSide;

// The figure with more leaves, which have density in both frames.
voctree::VOctree with_leaves(const std::vector<voctree::LeafPosition>& more, float sigma) {
    const voctree::VOctree figure = figure_tree();
    voctree::VOctree tree = figure;
    std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(figure);
    std::vector<const float*> from;
    for (uint32_t leaf = 0; leaf < figure.leaf_count; ++leaf) from.push_back(figure.leaf(leaf));
    std::vector<float> speck(figure.weights_per_leaf());
    speck[0] = speck[1] = sigma;
    for (const voctree::LeafPosition& one : more) {
        positions.push_back(one);
        from.push_back(speck.data());
    }
    voctree::replace_leaves(tree, positions, from);
    return tree;
}

// The box around the figure in one frame, from the definition of its shape.
std::pair<glm::dvec3, glm::dvec3> box_of_figure(uint32_t frame) {
    glm::dvec3 low(1), high(0);
    for (uint32_t i = 0; i < kFigureSide * kFigureSide * kFigureSide; ++i) {
        const glm::dvec3 corner =
            kCell * glm::dvec3(i % kFigureSide, i / kFigureSide % kFigureSide, i / kFigureSide / kFigureSide);
        if (!figure_part(corner + 0.5 * kCell, frame)) continue;
        low = glm::min(low, corner);
        high = glm::max(high, corner + kCell);
    }
    return {low, high};
}

void expect_box(const std::pair<glm::dvec3, glm::dvec3>& box, const std::pair<glm::dvec3, glm::dvec3>& truth,
                double within) {
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(box.first[axis], truth.first[axis], within) << axis;
        EXPECT_NEAR(box.second[axis], truth.second[axis], within) << axis;
    }
}

TEST(SolidLeavesTest, ABodyWithoutFloatersIsWholeAtItsTime) {
    const voctree::SolidLeaves leaves(figure_tree());
    for (const uint32_t frame : {0u, 1u}) expect_box(leaves.box_at(frame), box_of_figure(frame), 1.01 * kCell);
    EXPECT_GT(box_of_figure(1).second.x, box_of_figure(0).second.x + 5 * kCell) << "the frames differ";
    EXPECT_NEAR(leaves.box_at(0.5).first.x, box_of_figure(0).first.x, 1.01 * kCell) << "both are there in between";
}

TEST(SolidLeavesTest, FloatersAreLeftOut) {
    // Beside the header, above it, and in front of it.
    const std::vector<voctree::LeafPosition> specks{
        {62, 40, 32, kFigureDepth}, {28, 63, 32, kFigureDepth}, {29, 62, 32, kFigureDepth}, {28, 20, 63, kFigureDepth}};
    const voctree::VOctree tree = with_leaves(specks, 250);
    ASSERT_EQ(voctree::occupied_box(tree).second.y, 1) << "the specks are in the box of all leaves";
    expect_box(voctree::SolidLeaves(tree).box_at(0), box_of_figure(0), 1.01 * kCell);
}

TEST(SolidLeavesTest, AThinHazeIsLeftOutAndASolidPartIsNot) {
    std::vector<voctree::LeafPosition> slab;
    for (uint32_t x = 20; x < 36; ++x)
        for (uint32_t z = 20; z < 36; ++z) slab.push_back({x, 62, z, kFigureDepth});
    expect_box(voctree::SolidLeaves(with_leaves(slab, 0.01f)).box_at(0), box_of_figure(0), 1.01 * kCell);
    EXPECT_NEAR(voctree::SolidLeaves(with_leaves(slab, 250)).box_at(0).second.y, 63 * kCell, 1e-6)
        << "a plate over the header is a part of the performer";
}

TEST(SolidLeavesTest, ASliceHasThoseOfItsTree) {
    const voctree::VOctree tree = figure_tree();
    const stream::QuantisedSlice slice = slice::quantised(voctree::slice_of(tree, 0));
    const voctree::VOctree again = voctree::tree_of(slice::values_of(slice, tree.box_min, tree.box_size), 25);
    const auto [low, high] = voctree::SolidLeaves(slice, tree.box_min, tree.box_size).box_at(0);
    EXPECT_EQ(std::pair(low, high), voctree::SolidLeaves(again).box_at(0));
    EXPECT_TRUE(glm::all(glm::lessThan(low, high)));
}

TEST(SolidLeavesTest, WhereNothingIsSolidTheBoxIsThatOfAllLeaves) {
    voctree::VOctree tree = figure_tree();
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) tree.leaf(leaf)[0] = -1;
    EXPECT_EQ(voctree::SolidLeaves(tree).box_at(0), voctree::occupied_box(tree));
}

}  // namespace
}  // namespace neuvv::test
