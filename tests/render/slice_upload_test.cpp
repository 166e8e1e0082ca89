// The straight path: a slice that is uploaded as it comes shows what its tree with weights shows, whose slice is built
// on the device.
#include "render/volume/slices/slice_upload.h"

#include <gtest/gtest.h>

#include "reference/slice.h"
#include "render/frame/frame_renderer.h"
#include "render/volume/slices/slice_layout.h"
#include "stream/random_slice.h"
#include "support/gpu_test.h"
#include "support/host_tree.h"
#include "support/look_at.h"
#include "voctree/tree_slice.h"

namespace neuvv::test {
namespace {

using SliceUploadTest = GpuTest;

constexpr glm::vec3 kBoxMin{-0.4f, 0.1f, -0.3f}, kBoxSize{0.9f, 1.1f, 0.8f};

// Leaves of mixed depths of which some have no opacity.
stream::QuantisedSlice slice_with_holes(uint64_t seed, uint32_t depth, uint32_t leaves, uint32_t degree) {
    stream::QuantisedSlice slice = random_slice(seed, depth, leaves, degree);
    for (size_t i = 0; i < slice.leaves.size(); i += 7) slice.planes[stream::kOpacityPlane][i] = 0;
    return slice;
}

TEST_F(SliceUploadTest, HoldsEveryLeafWithOpacityWhereAWalkFindsIt) {
    constexpr uint32_t kDepths[] = {2, 4, 8, 10};
    for (uint32_t degree = 0; degree <= stream::kMaxDegree; ++degree) {
        const stream::QuantisedSlice slice = slice_with_holes(degree + 5, kDepths[degree], 700, degree);
        const voctree::VOctree tree = voctree::tree_of(slice::values_of(slice, kBoxMin, kBoxSize), 25);
        const render::Field field = render::upload_slice(device(), slice, kBoxMin, kBoxSize);
        ASSERT_EQ(field.levels_above, 0u) << "else the check below would have to begin a level deeper";
        const HostTree host = download_tree(device(), field, *field.slice);
        const std::vector<reference::LeafSlice> truth = reference::slice_tree(tree, 0);
        TreeCheck check{host, tree, truth};
        check.visit(0, 0);
        EXPECT_LE(check.worst, 0x1p-10) << "fp16 rounds to 2^-11 of a number";
        uint32_t live = 0;
        for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
            EXPECT_EQ(check.met[leaf], slice.planes[stream::kOpacityPlane][leaf] > 0) << "leaf " << leaf;
            live += check.met[leaf];
        }
        EXPECT_GT(live, 5u);
        EXPECT_EQ(check.entries, host.count.slots);
        EXPECT_EQ(host.count.groups_x, gpu::groups_of(host.count.slots, kSliceGroup));
    }
}

// Two words of two numbers each; halves of one sign are in the order of their bits.
int32_t half_steps_between(glm::uvec2 a, glm::uvec2 b) {
    int32_t worst = 0;
    for (int word = 0; word < 2; ++word)
        for (const int shift : {0, 16}) {
            const auto bits_a = static_cast<int32_t>(a[word] >> shift & 0xffff),
                       bits_b = static_cast<int32_t>(b[word] >> shift & 0xffff);
            worst = std::max(worst, std::abs(bits_a - bits_b));
        }
    return worst;
}

TEST_F(SliceUploadTest, TheDeviceMakesTheEntriesOfTheHost) {
    for (uint32_t degree = 0; degree <= stream::kMaxDegree; ++degree)
        for (const uint32_t leaves : {2u, 699u}) {
            const stream::QuantisedSlice slice = slice_with_holes(degree + 5, 9, leaves, degree);
            std::array<HostTree, 2> trees;
            for (const render::Dequantiser by : {render::Dequantiser::kHost, render::Dequantiser::kDevice}) {
                const render::Field field = render::upload_slice(device(), slice, kBoxMin, kBoxSize, by);
                trees[by == render::Dequantiser::kDevice] = download_tree(device(), field, *field.slice);
            }
            EXPECT_EQ(trees[0].leaves, trees[1].leaves);
            EXPECT_EQ(trees[0].nodes, trees[1].nodes);
            ASSERT_EQ(trees[0].entries.size(), trees[1].entries.size());
            for (size_t i = 0; i < trees[0].entries.size(); ++i) {
                if (trees[0].leaves[i / sh_count(degree)] == kNoLeaf)
                    ASSERT_EQ(trees[0].entries[i], trees[1].entries[i]) << "node's entry " << i;
                else
                    ASSERT_LE(half_steps_between(trees[0].entries[i], trees[1].entries[i]), 1) << "entry " << i;
            }
        }
}

// The shape of both fields is the same, where all leaves have opacity.
TEST_F(SliceUploadTest, HasTheShapeOfTheTree) {
    for (const uint32_t odd : {0u, 1u}) {
        stream::QuantisedSlice slice{6, 1, {}, {}};
        slice.planes.resize(stream::planes_of(1));
        for (uint64_t cell = 0; cell < 300;
             ++cell)  // leaves of depth 5 or 6, so that the root is one level higher or not
            slice.leaves.push_back({cell * 16, 6 - odd});
        for (auto& plane : slice.planes) plane.assign(slice.leaves.size(), 500);
        const voctree::VOctree tree = voctree::tree_of(slice::values_of(slice, kBoxMin, kBoxSize), 25);
        const render::Field straight = render::upload_slice(device(), slice, kBoxMin, kBoxSize),
                            by_tree = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
        EXPECT_EQ(straight.levels_above, odd);
        EXPECT_EQ(straight.levels_above, by_tree.levels_above);
        EXPECT_EQ(straight.node_levels, by_tree.node_levels);
        EXPECT_EQ(straight.level_begin, by_tree.level_begin);
        EXPECT_EQ(straight.top_box.first, by_tree.top_box.first);
        EXPECT_EQ(straight.top_box.last, by_tree.top_box.last);
        EXPECT_EQ(straight.leaves_min, by_tree.leaves_min);
        EXPECT_EQ(straight.leaves_max, by_tree.leaves_max);
        EXPECT_EQ(straight.leaf_diagonal, by_tree.leaf_diagonal);
        EXPECT_EQ(straight.finest_level, by_tree.finest_level);
        EXPECT_EQ(straight.coarsest_level, by_tree.coarsest_level);
        EXPECT_LT(render::device_bytes(straight), 2 * render::device_bytes(by_tree));
    }
}

TEST_F(SliceUploadTest, DrawsAsItsTreeDoes) {
    const stream::QuantisedSlice slice = slice_with_holes(3, 8, 4000, 2);
    const voctree::VOctree tree = voctree::tree_of(slice::values_of(slice, kBoxMin, kBoxSize), 25);
    const render::Field straight = render::upload_slice(device(), slice, kBoxMin, kBoxSize),
                        by_tree = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
    const glm::dvec3 middle = glm::dvec3(kBoxMin) + 0.5 * glm::dvec3(kBoxSize);
    const stage::Camera camera = look_at(middle + glm::dvec3(1.2, 0.4, 1.5), middle, 96, 80, 1.2);
    for (const render::TraceMode mode : {render::TraceMode::kTree, render::TraceMode::kShaded}) {
        render::FrameSettings settings;
        settings.width = 96;
        settings.height = 80;
        settings.mode = mode;
        settings.instances = {{}};
        std::array<media::Image, 2> images;
        for (size_t i = 0; i < 2; ++i) {
            render::FrameRenderer renderer(device(), i == 0 ? straight : by_tree, {96, 80, 1});
            images[i] = renderer.render(camera, settings);
        }
        uint32_t covered = 0;
        for (size_t i = 0; i < images[0].rgba.size(); ++i) {
            ASSERT_NEAR(images[0].rgba[i], images[1].rgba[i], 1) << "byte " << i;
            covered += images[0].rgba[i] > 10 && i % 4 == 3;
        }
        EXPECT_GT(covered, 1000u);
    }
}

TEST_F(SliceUploadTest, MayBeEmpty) {
    stream::QuantisedSlice slice{4, 1, {}, {}};
    slice.planes.resize(stream::planes_of(1));
    for (const bool transparent : {false, true}) {
        if (transparent)
            slice = [] {
                stream::QuantisedSlice one = random_slice(1, 4, 20, 1);
                std::ranges::fill(one.planes[stream::kOpacityPlane], int16_t{0});
                return one;
            }();
        for (const render::Dequantiser by : {render::Dequantiser::kHost, render::Dequantiser::kDevice}) {
            const render::Field field = render::upload_slice(device(), slice, kBoxMin, kBoxSize, by);
            EXPECT_EQ(field.node_count(), 1u);
            render::FrameRenderer renderer(device(), field, {16, 16, 1});
            render::FrameSettings settings;
            settings.width = settings.height = 16;
            settings.instances = {{}};
            const media::Image image = renderer.render(look_at({2, 2, 2}, {0, 0.5, 0}, 16, 16, 1), settings);
            for (size_t i = 3; i < image.rgba.size(); i += 4) EXPECT_EQ(image.rgba[i], 0);
        }
    }
}

TEST_F(SliceUploadTest, CannotBePainted) {
    const stream::QuantisedSlice slice = random_slice(2, 4, 50, 0);
    const render::Field field = render::upload_slice(device(), slice, kBoxMin, kBoxSize);
    const render::Paints paints(device(), field);
    render::SliceCache cache(device(), field, paints);
    const render::SliceKey painted{0, 1};
    EXPECT_THROW(cache.request({&painted, 1}), RuntimeFailure);
    const render::SliceKey between{0.5f, 0};  // of a field of one frame
    cache.request({&between, 1});
    EXPECT_EQ(cache.find(between), 0u);
    cache.forget();
    EXPECT_TRUE(cache.nearest_built({})) << "it cannot be built anew, so it stays";
    EXPECT_EQ(cache.bytes(), 0u);
}

}  // namespace
}  // namespace neuvv::test
