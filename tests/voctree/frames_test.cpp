// A part of a clip's frames shows what the clip shows in them.
#include "voctree/frames.h"

#include <gtest/gtest.h>

#include <map>
#include <tuple>

#include "reference/slice.h"
#include "support/random_tree.h"

namespace neuvv::test {
namespace {

using Cell = std::tuple<uint32_t, uint32_t, uint32_t, uint32_t>;

std::map<Cell, uint32_t> leaves_by_cell(const voctree::VOctree& tree) {
    std::map<Cell, uint32_t> leaves;
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
    for (uint32_t i = 0; i < positions.size(); ++i)
        leaves[{positions[i].depth, positions[i].x, positions[i].y, positions[i].z}] = i;
    return leaves;
}

// Every leaf of the clip is in the part as it was, or has no density at this time and is left out.
void expect_same(const voctree::VOctree& clip, double frame, const voctree::VOctree& part, double part_frame) {
    const auto before = reference::slice_tree(clip, frame), after = reference::slice_tree(part, part_frame);
    const std::map<Cell, uint32_t> leaves = leaves_by_cell(part);
    for (const auto& [cell, i] : leaves_by_cell(clip)) {
        const auto found = leaves.find(cell);
        if (found == leaves.end()) {
            EXPECT_EQ(before[i].sigma, 0) << "leaf " << i;
            continue;
        }
        EXPECT_DOUBLE_EQ(after[found->second].sigma, before[i].sigma);
        EXPECT_DOUBLE_EQ(after[found->second].gamma, before[i].gamma);
        EXPECT_EQ(after[found->second].k, before[i].k);
    }
}

voctree::VOctree with_basis_per_frame() {
    voctree::VOctree tree = random_tree({.leaves = 300, .bases = 6, .frames = 6});
    for (std::vector<float>* rows : {&tree.sigma_basis, &tree.gamma_basis})
        for (uint32_t frame = 0; frame < 6; ++frame)
            for (uint32_t basis = 0; basis < 6; ++basis) (*rows)[size_t{6} * frame + basis] = frame == basis ? 1 : 0;
    return tree;
}

TEST(Frames, APartHasItsOwnBasesAndLeavesAlone) {
    const voctree::VOctree tree = with_basis_per_frame();
    const voctree::VOctree part = voctree::frames_of(tree, 2, 3);
    EXPECT_EQ(voctree::defect_of(part), "");
    EXPECT_EQ(part.frames, 3u);
    EXPECT_EQ(part.bases, 3u);
    EXPECT_LT(part.leaf_count, tree.leaf_count) << "some leaves have no density in these frames";
    for (const double frame : {0.0, 0.5, 1.0, 2.0}) expect_same(tree, 2 + frame, part, frame);
}

TEST(Frames, SharedBasesStay) {
    const voctree::VOctree tree = random_tree({.leaves = 300, .bases = 4, .frames = 6});
    const voctree::VOctree part = voctree::frames_of(tree, 1, 2);
    EXPECT_EQ(part.bases, 4u);
    for (const double frame : {0.0, 0.25, 1.0}) expect_same(tree, 1 + frame, part, frame);
}

TEST(Frames, APartWithoutThePerformerIsSound) {
    voctree::VOctree tree = with_basis_per_frame();
    for (uint32_t i = 0; i < tree.leaf_count; ++i) tree.leaf(i)[4] = -1;
    const voctree::VOctree part = voctree::frames_of(tree, 4, 1);
    EXPECT_EQ(voctree::defect_of(part), "");
    EXPECT_EQ(part.leaf_count, 0u);
}

}  // namespace
}  // namespace neuvv::test
