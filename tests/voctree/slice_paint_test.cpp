// Paint over slices on the host against the reference: leaf by leaf, and plane by plane as a stream has them.
#include "voctree/slice_paint.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "reference/paint.h"
#include "support/random_layer.h"
#include "voctree/sh_weights.h"
#include "voctree/tree_slice.h"

namespace neuvv::test {
namespace {

using Steps = std::vector<voctree::PaintStep>;
using Leaves = std::vector<reference::LeafSlice>;

constexpr uint32_t kBlends = 4;
// In units of the tolerances of worst_leaf and worst_plane.
constexpr double kWorst = 1;

voctree::VOctree tree_of_degree(uint32_t degree) {
    return random_tree({.seed = degree + 40, .node_levels = 3, .leaves = 300, .bases = 5, .hh_degree = degree});
}

std::vector<voctree::EditLayer> random_layers(const voctree::VOctree& tree, uint64_t seed) {
    Random random(seed);
    std::vector<voctree::EditLayer> layers;
    for (uint32_t i = 0; i < kBlends; ++i) layers.push_back(random_layer(tree, random));
    return layers;
}

// Four layers of all blends, half transparent ones among them.
Steps all_blends(const std::vector<voctree::EditLayer>& layers) {
    return {{&layers[0], kPaintTint, 0.75f},
            {&layers[1], kPaintNormal, 0.5f},
            {&layers[2], kPaintRecolour, 1},
            {&layers[3], kPaintMultiply, 0.25f}};
}

Leaves painted_by_reference(const voctree::VOctree& tree, const Steps& steps, double frame) {
    std::vector<reference::PaintStep> same;
    for (const voctree::PaintStep& step : steps) same.push_back({step.layer, step.blend, double{step.opacity}});
    Leaves leaves = reference::slice_tree(tree, frame);
    reference::paint(leaves, tree.hh_degree, same, frame);
    return leaves;
}

double colour_of(double k) {
    return reference::sigmoid(k * double{slice::kMeanHarmonic});
}

// The largest difference of leaves that FrameEdits paints, as a part of 1e-4: densities and coefficients by their own
// size, mean colours in linear light, because their logits differ where nobody sees it.
double worst_leaf(const voctree::VOctree& tree, const Steps& steps, float frame, const Leaves& truth) {
    const voctree::FrameEdits edits(steps, frame);
    const Leaves bare = reference::slice_tree(tree, double{frame});
    double worst = 0;
    const auto compare = [&](double found, double expected) {
        worst = std::max(worst, std::abs(found - expected) / std::max(std::abs(expected), 1.0) / 1e-4);
    };
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
        compare(double{edits.painted_density(leaf, static_cast<float>(bare[leaf].sigma))}, truth[leaf].sigma);
        slice::Colours k{};
        for (size_t c = 0; c < 3; ++c)
            for (size_t i = 0; i < sh_count(tree.hh_degree); ++i) k[c][i] = static_cast<float>(bare[leaf].k[c][i]);
        edits.paint_colours(leaf, tree.hh_degree, k);
        for (size_t c = 0; c < 3; ++c) {
            compare(colour_of(double{k[c][0]}), colour_of(truth[leaf].k[c][0]));
            for (size_t i = 1; i < sh_count(tree.hh_degree); ++i) compare(double{k[c][i]}, truth[leaf].k[c][i]);
        }
    }
    return worst;
}

// A tree of one frame that shows these leaves. Its slice is what that of the painted tree must be.
voctree::VOctree still_of(const voctree::VOctree& tree, const Leaves& leaves) {
    voctree::VOctree still = tree;
    make_still(still, tree.hh_degree);
    still.weights.assign(size_t{still.leaf_count} * still.weights_per_leaf(), 0.0f);
    for (uint32_t leaf = 0; leaf < still.leaf_count; ++leaf) {
        float* weights = still.leaf(leaf);
        weights[0] = static_cast<float>(leaves[leaf].sigma);
        for (size_t c = 0; c < 3; ++c) {
            std::array<float, kMaxShCount> k{};
            for (size_t i = 0; i < k.size(); ++i) k[i] = static_cast<float>(leaves[leaf].k[c][i]);
            voctree::write_sh(weights + 2 + c * hh_count(tree.hh_degree), tree.hh_degree, k.data());
        }
    }
    return still;
}

// The largest difference between planes, in steps of 1 / stream::kUnit, of which rounding may take one.
double worst_plane(const voctree::VOctree& tree, const Steps& steps, uint32_t frame, const Leaves& truth) {
    const stream::QuantisedSlice found = slice::quantised(voctree::slice_of(tree, frame, steps));
    const stream::QuantisedSlice expected = slice::quantised(voctree::slice_of(still_of(tree, truth), 0));
    EXPECT_GT(found.leaves.size(), 20u);
    if (found.leaves != expected.leaves) return INFINITY;
    double worst = 0;
    for (size_t plane = 0; plane < found.planes.size(); ++plane)
        for (size_t i = 0; i < found.leaves.size(); ++i)
            worst = std::max<double>(worst, std::abs(found.planes[plane][i] - expected.planes[plane][i]));
    return worst;
}

TEST(SlicePaint, EveryLeafIsAsTheReferencePaintsIt) {
    for (uint32_t degree = 0; degree <= kMaxHhDegree; ++degree) {
        const voctree::VOctree tree = tree_of_degree(degree);
        const std::vector<voctree::EditLayer> layers = random_layers(tree, degree);
        for (const float frame : {0.0f, 2.0f, 2.5f, 4.0f}) {
            for (uint32_t blend = 0; blend < kBlends; ++blend) {
                SCOPED_TRACE(testing::Message() << "degree " << degree << " blend " << blend << " frame " << frame);
                const Steps one = {{&layers[blend], blend, 1}};
                EXPECT_LE(worst_leaf(tree, one, frame, painted_by_reference(tree, one, double{frame})), kWorst);
            }
            const Steps all = all_blends(layers);
            EXPECT_LE(worst_leaf(tree, all, frame, painted_by_reference(tree, all, double{frame})), kWorst);
        }
    }
}

TEST(SlicePaint, EveryPlaneOfASliceIsPainted) {
    for (uint32_t degree = 0; degree <= kMaxHhDegree; ++degree) {
        const voctree::VOctree tree = tree_of_degree(degree);
        const std::vector<voctree::EditLayer> layers = random_layers(tree, degree);
        for (const uint32_t frame : {0u, 1u, 4u}) {
            SCOPED_TRACE(testing::Message() << "degree " << degree << " frame " << frame);
            for (uint32_t blend = 0; blend < kBlends; ++blend) {
                const Steps one = {{&layers[blend], blend, 1}};
                EXPECT_LE(worst_plane(tree, one, frame, painted_by_reference(tree, one, frame)), kWorst) << blend;
            }
            const Steps all = all_blends(layers);
            EXPECT_LE(worst_plane(tree, all, frame, painted_by_reference(tree, all, frame)), kWorst);
        }
    }
}

TEST(SlicePaint, TheComparisonsNoticeAnotherBlendOrOrderOrOpacity) {
    const voctree::VOctree tree = tree_of_degree(1);
    const std::vector<voctree::EditLayer> layers = random_layers(tree, 7);
    const Steps used = all_blends(layers);
    const auto expect_noticed = [&](const Steps& wrong) {
        EXPECT_GT(worst_leaf(tree, used, 2, painted_by_reference(tree, wrong, 2)), 10 * kWorst);
        EXPECT_GT(worst_plane(tree, used, 2, painted_by_reference(tree, wrong, 2)), 10 * kWorst);
    };
    Steps wrong = used;
    wrong[0].blend = kPaintRecolour;
    expect_noticed(wrong);
    wrong = used;
    wrong[1].opacity = 0.6f;
    expect_noticed(wrong);
    expect_noticed({used[1], used[0], used[2], used[3]});
    expect_noticed({});
}

TEST(SlicePaint, ErasedLeavesAreLeftOutAndRevivedOnesAreThere) {
    const voctree::VOctree tree = tree_of_degree(1);
    voctree::EditLayer gone{voctree::painted_field(tree), {}}, solid = gone;
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
        gone.edits.push_back({leaf, 1, 2, glm::vec3(0), 0, 0});
        solid.edits.push_back({leaf, 2, 2, {1, 0, 0}, 1, 50});
    }
    const auto whole = [&](double frame, const Steps& steps = {}) {
        return slice::quantised(voctree::slice_of(tree, frame, steps));
    };
    const Steps erased = {{&gone}}, both = {{&gone}, {&solid}};
    EXPECT_TRUE(voctree::slice_of(tree, 1, erased).leaves.empty());
    EXPECT_EQ(whole(3, erased).planes, whole(3).planes) << "past its last frame";
    EXPECT_LT(voctree::slice_of(tree, 2).leaves.size(), tree.leaf_count);
    EXPECT_TRUE(voctree::slice_of(tree, 1, both).leaves.empty());
    const stream::QuantisedSlice red = slice::quantised(voctree::slice_of(tree, 2, both));
    ASSERT_EQ(red.leaves.size(), tree.leaf_count);
    for (size_t i = 0; i < red.leaves.size(); ++i) {
        const stream::Rgb shown =
            stream::rgb_of({static_cast<float>(red.planes[1][i]), static_cast<float>(red.planes[2][i]),
                            static_cast<float>(red.planes[3][i])});
        EXPECT_GT(shown.r, 0.99f * stream::kUnit);
        EXPECT_LT(shown.g, 0.01f * stream::kUnit);
    }
    const Steps half = {{&gone, kPaintNormal, 0.5f}};
    EXPECT_EQ(whole(1, half).leaves, whole(1).leaves) << "half of its density stays";
    EXPECT_NE(whole(1, half).planes[0], whole(1).planes[0]);
}

}  // namespace
}  // namespace neuvv::test
