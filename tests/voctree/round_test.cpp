// Tests that rounding weights changes opacity and colour by no more than allowed, and leaves numbers with few digits.
#include "voctree/round.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "reference/sample.h"
#include "reference/slice.h"
#include "support/random_tree.h"
#include "voctree/temporal_basis.h"

namespace neuvv::test {
namespace {

struct Difference {
    double opacity = 0,
           colour = 0;  // the largest: of a leaf's opacity along its edge; of its colour in linear light times opacity
};

Difference difference(const voctree::VOctree& before, const voctree::VOctree& after) {
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(before);
    const glm::dvec3 direction = glm::normalize(glm::dvec3(0.3, -0.5, 0.8));
    Difference largest;
    for (uint32_t frame = 0; frame < before.frames; ++frame) {
        const auto was = reference::slice_tree(before, frame), is = reference::slice_tree(after, frame);
        for (uint32_t leaf = 0; leaf < before.leaf_count; ++leaf) {
            const double edge = voctree::leaf_edge_m(before, positions[leaf].depth);
            const double seen = 1 - std::exp(-was[leaf].sigma * edge), sees = 1 - std::exp(-is[leaf].sigma * edge);
            largest.opacity = std::max(largest.opacity, std::abs(seen - sees));
            if (was[leaf].sigma <= 0 || is[leaf].sigma <= 0) continue;
            const glm::dvec3 off = glm::abs(reference::sample_colour(was[leaf], before.hh_degree, direction) -
                                            reference::sample_colour(is[leaf], before.hh_degree, direction));
            largest.colour = std::max({largest.colour, seen * off.x, seen * off.y, seen * off.z});
        }
    }
    return largest;
}

// With a basis for each frame, w^σ of a frame alone decides the opacity in that frame.
voctree::VOctree own_frames_tree() {
    voctree::VOctree tree = random_tree({.seed = 8, .leaves = 300, .bases = 6, .hh_degree = 2, .frames = 6});
    std::fill(tree.sigma_basis.begin(), tree.sigma_basis.end(), 0.0f);
    for (uint32_t t = 0; t < 6; ++t) tree.sigma_basis[t * 6 + t] = 1;
    tree.gamma_basis = tree.sigma_basis;
    return tree;
}

TEST(Round, LeavesShowNoMoreThanTheError) {
    const voctree::VOctree tree = own_frames_tree();
    for (const float error : {0.001f, 0.01f, 0.1f, 0.5f}) {
        voctree::VOctree rounded = tree;
        voctree::round_weights(rounded, error);
        EXPECT_EQ(voctree::defect_of(rounded), "");
        const Difference off = difference(tree, rounded);
        EXPECT_LE(off.opacity, 1.001 * error);
        EXPECT_GT(off.opacity, 0.2 * error);
        EXPECT_LE(off.colour, 3 * error);  // γ and 14 functions, each within its share of `error`
        EXPECT_GT(off.colour, 0.05 * error);
    }
}

TEST(Round, SharedBasesKeepTheirSums) {
    const voctree::VOctree tree = random_tree({.seed = 8, .leaves = 300, .bases = 4, .hh_degree = 1, .frames = 6});
    voctree::VOctree rounded = tree;
    voctree::round_weights(rounded, 0.01f);
    EXPECT_LE(difference(tree, rounded).opacity, 4 * 0.01);  // of four weights each
}

TEST(Round, FewDigitsRemainAndHiddenNumbersGo) {
    voctree::VOctree tree = own_frames_tree();
    for (uint32_t c = 0; c < 6; ++c) tree.leaf(7)[c] = -1;  // empty in every frame
    voctree::round_weights(tree, 0.1f);
    std::set<float> sigmas, colours;
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
        sigmas.insert(tree.leaf(leaf), tree.leaf(leaf) + 6);
        colours.insert(tree.leaf(leaf) + 12, tree.leaf(leaf) + tree.weights_per_leaf());
    }
    EXPECT_LT(sigmas.size(), 300u);   // of 1800
    EXPECT_LT(colours.size(), 500u);  // of 12600
    for (uint32_t c = 0; c < 6; ++c) EXPECT_EQ(tree.leaf(7)[6 + c], 0);
}

}  // namespace
}  // namespace neuvv::test
