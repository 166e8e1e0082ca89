// The tree of a run: its beginning, pruning and division.
#include "training/tree/grow.h"

#include <gtest/gtest.h>

#include "support/random_tree.h"
#include "support/sphere_capture.h"
#include "training/tree/first_tree.h"

namespace neuvv::test {
namespace {

const SphereCapture kCapture{.cameras = 8, .frames = 3, .size = 40};

const training::Dataset& capture() {
    static const training::Dataset dataset = sphere_dataset(kCapture);
    return dataset;
}

voctree::VOctree first_tree() {
    return training::initial_tree(capture(), {.resolution = 32, .bases = 31, .hh_degree = 1}, 2);
}

glm::dvec3 centre_of(const voctree::LeafPosition& position) {
    return (glm::dvec3(position.x, position.y, position.z) + 0.5) / std::exp2(position.depth);
}

glm::dvec3 world_of(const voctree::VOctree& tree, glm::dvec3 position) {
    return glm::dvec3(tree.box_min) + position * glm::dvec3(tree.box_size);
}

// σ before relu: the weight itself, as the trees have as many hat bases as frames.
float sigma_at(const voctree::VOctree& tree, uint32_t leaf, uint32_t frame) {
    return tree.leaf(leaf)[frame];
}

// The first tree, with this optical depth over the edge of each leaf in all frames in which it has density.
voctree::VOctree first_tree_of_depth(float optical_depth) {
    voctree::VOctree tree = first_tree();
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
        for (uint32_t frame = 0; frame < tree.frames; ++frame)
            if (tree.leaf(leaf)[frame] > 0)
                tree.leaf(leaf)[frame] =
                    optical_depth * static_cast<float>(1u << positions[leaf].depth) / tree.box_size.x;
    return tree;
}

// Thinner and denser than what counts as hidden where rays do not use it.
constexpr float kThin = 0.05f, kDense = 0.2f;

// A use in which every frame used every leaf. Opacity sensitivities equal the given maximum weights.
training::LeafUse use_of(const voctree::VOctree& tree, const std::vector<float>& max_weight) {
    return {max_weight, max_weight, std::vector<uint32_t>(size_t{(tree.frames + 31) / 32} * tree.leaf_count, ~0u)};
}

// Expects a sound tree in which no leaf lies inside another: a search at each leaf's centre finds that leaf.
void expect_sound(const voctree::VOctree& tree) {
    EXPECT_EQ(voctree::defect_of(tree), "");
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
    for (uint32_t leaf = 0; leaf < positions.size(); ++leaf)
        ASSERT_EQ(voctree::find_leaf(tree, centre_of(positions[leaf])), leaf);
}

TEST(Grow, DepthOfAResolution) {
    const std::pair<uint32_t, uint32_t> kDepths[] = {{1, 1}, {2, 1}, {3, 2}, {8, 3}, {9, 4}, {512, 9}, {2048, 11}};
    for (const auto& [resolution, depth] : kDepths)
        EXPECT_EQ(training::depth_of_resolution(resolution), depth) << resolution;
}

TEST(Grow, NaturalResolutionIsAPixelALeaf) {
    training::Dataset dataset = capture();
    const std::pair<glm::dvec3, glm::dvec3> box = {{-1, -0.5, -0.5}, {1, 0.5, 0.5}};
    for (stage::Camera& camera : dataset.cameras) camera.fx = 150;  // at 3 m, a pixel covers 2 cm
    EXPECT_EQ(training::natural_resolution(dataset, box), 100u);
    for (stage::Camera& camera : dataset.cameras) camera.fx = 1e-3;
    EXPECT_EQ(training::natural_resolution(dataset, box), 32u);
    for (stage::Camera& camera : dataset.cameras) camera.fx = 1e9;
    EXPECT_EQ(training::natural_resolution(dataset, box), 512u);
}

TEST(Grow, FirstTreeHoldsTheSphereInCubes) {
    const voctree::VOctree tree = first_tree();
    expect_sound(tree);
    EXPECT_EQ(tree.box_size.x, tree.box_size.y);
    EXPECT_EQ(tree.box_size.x, tree.box_size.z);
    EXPECT_EQ(tree.frames, 3u);
    EXPECT_EQ(tree.bases, 3u);  // no more than one per frame
    EXPECT_EQ(tree.fps, 25);
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
    for (const voctree::LeafPosition& position : positions)
        EXPECT_EQ(position.depth, 3u);  // 5 for 32 cells, less two levels
    EXPECT_LT(positions.size(), 512u);
    for (uint32_t frame = 0; frame < 3; ++frame) {
        const glm::dvec3 centre = kCapture.centre(kCapture.time(frame));
        for (const glm::dvec3 off : {glm::dvec3(0), glm::dvec3(0.38, 0, 0), glm::dvec3(-0.2, 0.2, 0.2)}) {
            const glm::dvec3 position = (centre + off - glm::dvec3(tree.box_min)) / glm::dvec3(tree.box_size);
            const uint32_t leaf = voctree::find_leaf(tree, position);
            ASSERT_NE(leaf, UINT32_MAX);
            EXPECT_GT(sigma_at(tree, leaf, frame), 0);
        }
    }
}

TEST(Grow, FirstTreeIsEmptyWhereAndWhenTheHullForbids) {
    const voctree::VOctree tree = first_tree();
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
    size_t forbidden = 0;
    for (uint32_t leaf = 0; leaf < positions.size(); ++leaf) {
        const glm::dvec3 centre = world_of(tree, centre_of(positions[leaf]));
        bool ever = false;
        for (uint32_t frame = 0; frame < 3; ++frame) {
            ever |= sigma_at(tree, leaf, frame) > 0;
            const double distance = glm::length(centre - kCapture.centre(kCapture.time(frame)));
            if (distance < kCapture.radius_m) {
                EXPECT_GT(sigma_at(tree, leaf, frame), 0);
            }
            forbidden += sigma_at(tree, leaf, frame) < 0 ? 1 : 0;
        }
        EXPECT_TRUE(ever) << "a leaf that is never allowed";
    }
    EXPECT_GT(forbidden, positions.size() / 10);
}

TEST(Grow, PrunesWhatIsNotReached) {
    voctree::VOctree tree = first_tree_of_depth(kThin);
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) tree.leaf(leaf)[6] = static_cast<float>(leaf);
    std::vector<float> max_weight(tree.leaf_count, 0.5f);
    for (uint32_t leaf = 0; leaf < tree.leaf_count; leaf += 3) max_weight[leaf] = 0.001f;
    const voctree::VOctree grown =
        training::grow(capture(), tree, use_of(tree, max_weight), {.max_depth = 5, .prune_below = 0.01f});
    expect_sound(grown);
    EXPECT_EQ(grown.leaf_count, tree.leaf_count - (tree.leaf_count + 2) / 3);
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(grown);
    for (uint32_t leaf = 0; leaf < grown.leaf_count; ++leaf) {
        const uint32_t before = voctree::find_leaf(tree, centre_of(positions[leaf]));
        EXPECT_NE(before % 3, 0u);
        EXPECT_TRUE(std::equal(grown.leaf(leaf), grown.leaf(leaf) + grown.weights_per_leaf(), tree.leaf(before)));
    }
}

TEST(Grow, NothingReachedLeavesTheTree) {
    const voctree::VOctree tree = first_tree_of_depth(kThin);
    const voctree::VOctree grown = training::grow(capture(), tree, use_of(tree, std::vector<float>(tree.leaf_count)),
                                                  {.max_depth = 5, .prune_below = 0.01f});
    EXPECT_EQ(grown.weights, tree.weights);
}

TEST(Grow, LeavesThatOthersHideStay) {
    const voctree::VOctree thin = first_tree_of_depth(kThin), dense = first_tree_of_depth(kDense);
    voctree::VOctree tree = thin;  // every second leaf is dense; the first half of all were not reached
    std::vector<float> max_weight(tree.leaf_count, 0.5f);
    size_t removed = 0;
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
        if (leaf % 2 == 0) std::copy_n(dense.leaf(leaf), tree.weights_per_leaf(), tree.leaf(leaf));
        if (leaf < tree.leaf_count / 2) max_weight[leaf] = 0;
        removed += leaf < tree.leaf_count / 2 && leaf % 2 == 1 ? 1 : 0;
    }
    training::LeafUse use = use_of(tree, max_weight);
    for (uint32_t leaf = 0; leaf < tree.leaf_count / 2; ++leaf) use.frames[leaf] = 0;
    const voctree::VOctree grown =
        training::grow(capture(), tree, use, {.max_depth = 5, .prune_below = 0.01f, .empty_unused = true});
    expect_sound(grown);
    EXPECT_EQ(grown.leaf_count, tree.leaf_count - removed);
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(grown);
    for (uint32_t leaf = 0; leaf < grown.leaf_count; ++leaf) {
        const uint32_t before = voctree::find_leaf(tree, centre_of(positions[leaf]));
        EXPECT_TRUE(before >= tree.leaf_count / 2 || before % 2 == 0) << before;
        for (uint32_t frame = 0; frame < 3; ++frame)
            EXPECT_NEAR(sigma_at(grown, leaf, frame), sigma_at(tree, before, frame), 1e-3f);
    }
}

TEST(Grow, ChildrenInheritColoursAndDensityWhereTheHullAllows) {
    voctree::VOctree tree = first_tree();
    Random random(2);
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
        for (uint32_t i = 3; i < tree.weights_per_leaf(); ++i) tree.leaf(leaf)[i] = static_cast<float>(random.bell());
    std::vector<float> max_weight(tree.leaf_count, 0.01f);
    for (uint32_t leaf = 0; leaf < tree.leaf_count; leaf += 2) max_weight[leaf] = 0.9f;
    const voctree::VOctree grown =
        training::grow(capture(), tree, use_of(tree, max_weight), {.max_depth = 5, .min_weight_to_divide = 0.5f});
    expect_sound(grown);
    size_t children = 0, emptied = 0;
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(grown);
    for (uint32_t leaf = 0; leaf < grown.leaf_count; ++leaf) {
        const glm::dvec3 centre = centre_of(positions[leaf]);
        const uint32_t parent = voctree::find_leaf(tree, centre);
        const bool child = positions[leaf].depth == 4;
        EXPECT_EQ(child, parent % 2 == 0);
        children += child ? 1 : 0;
        EXPECT_TRUE(
            std::equal(grown.leaf(leaf) + 3, grown.leaf(leaf) + grown.weights_per_leaf(), tree.leaf(parent) + 3));
        for (uint32_t frame = 0; frame < 3; ++frame) {
            const float before = sigma_at(tree, parent, frame), now = sigma_at(grown, leaf, frame);
            const double distance = glm::length(world_of(grown, centre) - kCapture.centre(kCapture.time(frame)));
            if (!child || now > 0 || distance < kCapture.radius_m)
                EXPECT_NEAR(now, before, 1e-4f * std::abs(before));
            else
                emptied += before > 0 ? 1 : 0;
        }
    }
    EXPECT_GT(children, tree.leaf_count);  // every second leaf has those of 8 children that the hull allows
    EXPECT_GT(emptied, 0u);
}

TEST(Grow, StaysWithinDepthAndLeafLimits) {
    const voctree::VOctree tree = first_tree();
    std::vector<float> max_weight(tree.leaf_count);
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) max_weight[leaf] = 0.1f + static_cast<float>(leaf) * 1e-3f;
    const training::GrowSettings at_depth{.max_depth = 3, .min_weight_to_divide = 0.01f};
    EXPECT_EQ(training::grow(capture(), tree, use_of(tree, max_weight), at_depth).leaf_count, tree.leaf_count);

    const training::GrowSettings limited{
        .max_depth = 5, .min_weight_to_divide = 0.01f, .max_leaves = tree.leaf_count + 7 * 10};
    const voctree::VOctree grown = training::grow(capture(), tree, use_of(tree, max_weight), limited);
    expect_sound(grown);
    EXPECT_LE(grown.leaf_count, limited.max_leaves);
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(grown);
    for (const voctree::LeafPosition& position :
         positions)  // the ten leaves of highest maximum weight, which are the last
        if (position.depth > 3) {
            EXPECT_GE(voctree::find_leaf(tree, centre_of(position)), tree.leaf_count - 10);
        }
    EXPECT_TRUE(
        std::any_of(positions.begin(), positions.end(), [](const voctree::LeafPosition& p) { return p.depth == 4; }));
}

TEST(Grow, ABoundOnLeavesKeepsThoseOfMostReach) {
    const voctree::VOctree tree = first_tree();
    std::vector<float> max_weight(tree.leaf_count);
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
        max_weight[leaf] = 0.5f - static_cast<float>(leaf / 2) * 1e-3f;
    const voctree::VOctree grown =
        training::grow(capture(), tree, use_of(tree, max_weight), {.max_depth = 5, .max_leaves = 21});
    expect_sound(grown);
    EXPECT_EQ(grown.leaf_count, 21u);  // one of the two equal leaves at the bound
    for (const voctree::LeafPosition& position : voctree::leaf_positions(grown))
        EXPECT_LE(voctree::find_leaf(tree, centre_of(position)), 20u);
}

TEST(Grow, DividesWhereTheLossPullsHardest) {
    const voctree::VOctree tree = first_tree();
    training::LeafUse use = use_of(tree, std::vector<float>(tree.leaf_count, 0.5f));
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
        use.opacity_sensitivity[leaf] = static_cast<float>(leaf * 7 % 101);
    const voctree::VOctree grown =
        training::grow(capture(), tree, use, {.max_depth = 5, .min_weight_to_divide = 0.1f, .divide_share = 0.25f});
    expect_sound(grown);
    float min_divided = 1000, max_undivided = 0;
    size_t whole = 0;
    for (const voctree::LeafPosition& position : voctree::leaf_positions(grown)) {
        const float opacity_sensitivity = use.opacity_sensitivity[voctree::find_leaf(tree, centre_of(position))];
        if (position.depth == 4)
            min_divided = std::min(min_divided, opacity_sensitivity);
        else {
            max_undivided = std::max(max_undivided, opacity_sensitivity);
            ++whole;
        }
    }
    EXPECT_GE(min_divided, max_undivided);
    EXPECT_EQ(whole, tree.leaf_count - tree.leaf_count / 4);
}

TEST(Grow, NoLeafDividesThatShowsSmallerThanAsked) {
    const voctree::VOctree tree = first_tree();
    const training::LeafUse use = use_of(tree, std::vector<float>(tree.leaf_count, 0.5f));
    const double edge = static_cast<double>(tree.box_size.x) / 8;
    const double footprint = kCapture.distance_m / capture().cameras[0].fx;  // of a pixel in the centre of the ring
    const training::GrowSettings too_small{
        .max_depth = 5, .min_weight_to_divide = 0.1f, .min_pixels_to_divide = 2.5 * edge / footprint};
    EXPECT_EQ(training::grow(capture(), tree, use, too_small).leaf_count, tree.leaf_count);
    const training::GrowSettings large{
        .max_depth = 5, .min_weight_to_divide = 0.1f, .min_pixels_to_divide = 0.3 * edge / footprint};
    const voctree::VOctree grown = training::grow(capture(), tree, use, large);
    for (const voctree::LeafPosition& position : voctree::leaf_positions(grown)) EXPECT_EQ(position.depth, 4u);
}

TEST(Grow, LeavesAreEmptiedInFramesThatDidNotUseThem) {
    const voctree::VOctree tree = first_tree_of_depth(kThin);
    training::LeafUse use = use_of(tree, std::vector<float>(tree.leaf_count, 0.5f));
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) use.frames[leaf] = leaf % 2 ? 0b101 : 0b111;
    const voctree::VOctree grown = training::grow(capture(), tree, use, {.max_depth = 5, .empty_unused = true});
    ASSERT_EQ(grown.leaf_count, tree.leaf_count);
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(grown);
    size_t emptied = 0;
    for (uint32_t leaf = 0; leaf < grown.leaf_count; ++leaf) {
        const uint32_t before = voctree::find_leaf(tree, centre_of(positions[leaf]));
        for (uint32_t frame = 0; frame < 3; ++frame) {
            const bool unused = before % 2 == 1 && frame == 1;
            const float sigma = sigma_at(grown, leaf, frame), was = sigma_at(tree, before, frame);
            EXPECT_TRUE(unused ? sigma < 0 : std::abs(sigma - was) < 1e-3f) << sigma << ' ' << was;
            emptied += unused && sigma_at(tree, before, frame) > 0 ? 1 : 0;
        }
    }
    EXPECT_GT(emptied, 10u);
}

}  // namespace
}  // namespace neuvv::test
