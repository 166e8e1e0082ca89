// The slice passes against the reference: σ, SH coefficients, slots.
#include "render/volume/slices/slice.h"
#include "gpu/host_copies.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "reference/slice.h"
#include "support/gpu_test.h"
#include "support/random_tree.h"

namespace neuvv::test {
namespace {

struct DeviceSlice {
    std::vector<glm::uvec2> head;  // per leaf (σ bits, slot)
    std::vector<uint32_t> slot_leaf;
    LiveCount live;
    std::vector<glm::vec4> sh;
};

DeviceSlice slice_on(const gpu::Device& device, const render::Field& field, float frame, uint32_t slots) {
    const render::Slice slice(device, field, slots);
    const render::Slicer slicer(device, field, slice);
    gpu::run_once(device, "slice", [&](gpu::Commands& commands) { render::record_slice(commands, slicer, frame); });
    DeviceSlice result;
    result.head.resize(field.leaf_count);
    result.slot_leaf.resize(slice.capacity);
    result.sh.resize(size_t{slice.capacity} * sh_count(field.hh_degree));
    gpu::download(device, slice.head, result.head.data(), result.head.size() * sizeof(glm::uvec2));
    gpu::download(device, slice.slot_leaf, result.slot_leaf.data(), result.slot_leaf.size() * sizeof(uint32_t));
    gpu::download(device, slice.live, &result.live, sizeof(LiveCount));
    gpu::download(device, slice.sh, result.sh.data(), result.sh.size() * sizeof(glm::vec4));
    return result;
}

float sigma_of(const DeviceSlice& slice, uint32_t leaf) {
    return std::bit_cast<float>(slice.head[leaf].x);
}

// The tolerance of sums of a few dozen products in single precision, of numbers around 1 to 10.
constexpr double kSliceTolerance = 2e-5;

// Every live leaf has a slot of its own that points back to it.
void expect_sound_slots(const DeviceSlice& slice) {
    std::vector<bool> taken(slice.slot_leaf.size());
    uint32_t live = 0;
    for (uint32_t leaf = 0; leaf < slice.head.size(); ++leaf) {
        if (sigma_of(slice, leaf) == 0) continue;
        const uint32_t slot = slice.head[leaf].y;
        ASSERT_LT(slot, taken.size());
        EXPECT_FALSE(taken[slot]) << "slot " << slot << " twice";
        taken[slot] = true;
        EXPECT_EQ(slice.slot_leaf[slot], leaf);
        ++live;
    }
    EXPECT_EQ(slice.live.slots, live + slice.live.overflow);
    EXPECT_EQ(slice.live.groups_x, (live + kSliceGroup - 1) / kSliceGroup);
    EXPECT_EQ(slice.live.groups_y, 1u);
    EXPECT_EQ(slice.live.groups_z, 1u);
}

// The largest difference of σ and of the coefficients of live leaves, relative to max(1, truth).
double slice_error(const DeviceSlice& slice, const voctree::VOctree& tree, double frame) {
    const std::vector<reference::LeafSlice> truth = reference::slice_tree(tree, frame);
    double worst = 0;
    const auto compare = [&worst](double value, double expected) {
        worst = std::max(worst, std::abs(value - expected) / std::max(1.0, std::abs(expected)));
    };
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
        compare(sigma_of(slice, leaf), truth[leaf].sigma);
        if (sigma_of(slice, leaf) == 0) continue;
        for (size_t j = 0; j < sh_count(tree.hh_degree); ++j)
            for (size_t channel = 0; channel < 3; ++channel)
                compare(slice.sh[size_t{slice.head[leaf].y} * sh_count(tree.hh_degree) + j][static_cast<int>(channel)],
                        truth[leaf].k[channel][j]);
    }
    return worst;
}

// Weights that fp16 does not represent.
voctree::VOctree unrounded_tree(const RandomTreeOptions& options) {
    voctree::VOctree tree = random_tree(options);
    Random random(options.seed + 1);
    for (float& weight : tree.weights) weight += static_cast<float>(0.01 * random.bell());
    return tree;
}

using SliceTest = GpuTest;

TEST_F(SliceTest, MatchesTheReferenceForEveryDegreeAtAnyFrame) {
    constexpr uint32_t kBases[] = {1, 6, 31, 64};
    for (uint32_t degree = 0; degree <= kMaxHhDegree; ++degree) {
        const voctree::VOctree tree = unrounded_tree({.seed = degree, .bases = kBases[degree], .hh_degree = degree});
        const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
        for (const float frame : {0.0f, 3.0f, 4.0f, 1.25f, 3.9f, -1.0f, 7.0f}) {
            const DeviceSlice slice = slice_on(device(), field, frame, field.leaf_count);
            EXPECT_LE(slice_error(slice, tree, frame), kSliceTolerance) << "degree " << degree << ", frame " << frame;
            EXPECT_EQ(slice.live.overflow, 0u);
            EXPECT_GT(slice.live.slots, field.leaf_count / 10);
            expect_sound_slots(slice);
        }
    }
}

TEST_F(SliceTest, HalfWeightsAreTheRoundedWeights) {
    voctree::VOctree tree = unrounded_tree({.seed = 9, .bases = 7, .hh_degree = 2});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const DeviceSlice slice = slice_on(device(), field, 2.5f, field.leaf_count);
    EXPECT_GT(slice_error(slice, tree, 2.5), 10 * kSliceTolerance)
        << "the rounding of fp16 does not show: is it tested?";
    for (float& weight : tree.weights) weight = voctree::float_from_half(voctree::half_from_float(weight));
    EXPECT_LE(slice_error(slice, tree, 2.5), kSliceTolerance);
    expect_sound_slots(slice);
}

TEST_F(SliceTest, LeavesWithoutASlotAreDeadAndCounted) {
    const voctree::VOctree tree = random_tree({.seed = 3, .bases = 5, .hh_degree = 1});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
    const std::vector<reference::LeafSlice> truth = reference::slice_tree(tree, 1);
    uint32_t alive = 0;
    for (const auto& leaf : truth) alive += leaf.sigma > 0;
    constexpr uint32_t kSlots = 70;
    ASSERT_GT(alive, kSlots);
    const DeviceSlice slice = slice_on(device(), field, 1, kSlots);
    EXPECT_EQ(slice.live.slots, alive);
    EXPECT_EQ(slice.live.overflow, alive - kSlots);
    expect_sound_slots(slice);
    uint32_t kept = 0;
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
        if (sigma_of(slice, leaf) == 0) continue;
        ++kept;
        EXPECT_NEAR(sigma_of(slice, leaf), truth[leaf].sigma, kSliceTolerance * std::max(1.0, truth[leaf].sigma));
    }
    EXPECT_EQ(kept, kSlots);
}

TEST_F(SliceTest, AFrameWithoutDensityLeavesNoSlots) {
    voctree::VOctree tree = random_tree({.seed = 4});
    std::fill(tree.sigma_basis.begin(), tree.sigma_basis.end(), 0.0f);
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
    const DeviceSlice slice = slice_on(device(), field, 2, field.leaf_count);
    EXPECT_EQ(slice.live.slots, 0u);
    EXPECT_EQ(slice.live.groups_x, 0u);
    EXPECT_EQ(slice_error(slice, tree, 2), 0);
}

TEST(WeightPlanes, AreTheWeightsAndBack) {
    const voctree::VOctree tree = unrounded_tree({.seed = 6, .leaves = 50, .bases = 6, .hh_degree = 3});
    voctree::VOctree back = tree;
    std::fill(back.weights.begin(), back.weights.end(), 0.0f);
    render::weights_from_planes(render::weights_to_planes(tree), back);
    EXPECT_EQ(back.weights, tree.weights);
}

}  // namespace
}  // namespace neuvv::test
