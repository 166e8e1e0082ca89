// A frame as leaves against the reference's slice, and volumes of fewer leaves.
#include "interchange/volume/frame_volume.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "reference/slice.h"
#include "support/random_tree.h"

namespace neuvv::test {
namespace {

using interchange::FrameVolume;
using interchange::VolumeLeaf;

voctree::VOctree some_tree() {
    return random_tree({.node_levels = 3, .leaves = 400, .bases = 5, .hh_degree = 2});
}

double summed_density(const FrameVolume& volume) {
    double sum = 0;
    for (const VolumeLeaf& leaf : volume.leaves) sum += double{leaf.sigma} * std::exp2(-3.0 * leaf.depth);
    return sum;
}

// By first cell and depth.
std::map<std::pair<uint64_t, uint32_t>, VolumeLeaf> by_cell(const FrameVolume& volume) {
    std::map<std::pair<uint64_t, uint32_t>, VolumeLeaf> leaves;
    for (const VolumeLeaf& leaf : volume.leaves) leaves[{leaf.cell, leaf.depth}] = leaf;
    return leaves;
}

void expect_live_leaves(const voctree::VOctree& tree, double frame) {
    const FrameVolume volume = interchange::frame_volume(tree, frame);
    const auto leaves = by_cell(volume);
    const auto truth = reference::slice_tree(tree, frame);
    const auto positions = voctree::leaf_positions(tree);
    size_t live = 0;
    for (size_t i = 0; i < truth.size(); ++i) {
        const voctree::LeafPosition& at = positions[i];
        const auto found = leaves.find({voctree::first_cell(at, volume.depth), at.depth});
        const double edge = double{tree.box_size.x + tree.box_size.y + tree.box_size.z} / 3 / (1u << at.depth);
        if (1 - std::exp(-truth[i].sigma * edge) < 0.001) {
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
        EXPECT_LT(glm::distance(world, glm::dvec3(volume.centre_m(found->second))), 1e-6);
    }
    EXPECT_EQ(live, volume.leaves.size());
    EXPECT_GT(live, 100u);
}

TEST(FrameVolume, HasTheLiveLeavesOfTheSlice) {
    expect_live_leaves(some_tree(), 3);
}

TEST(FrameVolume, MixesFramesBetweenTwo) {
    expect_live_leaves(some_tree(), 2.25);
}

TEST(FrameVolume, OfFewerLeavesHidesAsMuch) {
    const FrameVolume whole = interchange::frame_volume(some_tree(), 0);
    const size_t count = whole.leaves.size();
    for (const size_t most : {count - 1, count / 2, count / 10, size_t{1}}) {
        const FrameVolume fewer = interchange::with_fewer_leaves(whole, most);
        EXPECT_LE(fewer.leaves.size(), most == 1 ? 8 : most);
        EXPECT_GE(fewer.leaves.size(), most == 1 ? 1 : most - 7) << "no more is merged than has to be";
        EXPECT_NEAR(summed_density(fewer), summed_density(whole), 1e-4 * summed_density(whole));
        for (size_t i = 1; i < fewer.leaves.size(); ++i) EXPECT_LT(fewer.leaves[i - 1].cell, fewer.leaves[i].cell);
    }
    EXPECT_EQ(interchange::with_fewer_leaves(whole, count).leaves.size(), count);
}

// Two groups of eight cells: one of the same leaves, one whose leaves differ.
TEST(FrameVolume, MergesWhatAgrees) {
    FrameVolume volume;
    for (uint64_t i = 0; i < 16; ++i) {
        VolumeLeaf leaf{i, 2, 3, {}, 1};
        for (auto& channel : leaf.colours) channel[0] = i < 8 && i % 2 == 0 ? 3.0f : 1.0f;
        volume.leaves.push_back(leaf);
    }
    const FrameVolume fewer = interchange::with_fewer_leaves(volume, 9);
    ASSERT_EQ(fewer.leaves.size(), 9u);
    EXPECT_EQ(fewer.leaves[8].cell, 8u);
    EXPECT_EQ(fewer.leaves[8].depth, 1u);
    EXPECT_FLOAT_EQ(fewer.leaves[8].sigma, 3);
    EXPECT_NEAR(fewer.leaves[8].colours[0][0], 1, 1e-6);
}

}  // namespace
}  // namespace neuvv::test
