// The slice tree against the reference's slice: live cells and their entries; and the ranges of tiles.
#include "render/volume/slices/slice_tree.h"
#include "gpu/host_copies.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "reference/camera.h"
#include "reference/slice.h"
#include "reference/trace.h"
#include "render/volume/tile_range.h"
#include "support/gpu_test.h"
#include "support/host_tree.h"
#include "support/look_at.h"
#include "support/random_tree.h"

namespace neuvv::test {
namespace {

using SliceTreeTest = GpuTest;

TEST_F(SliceTreeTest, HoldsEveryLiveLeafWhereAWalkFindsItAndNothingElse) {
    constexpr uint32_t kLevels[] = {1, 2, 4, 6};
    for (uint32_t degree = 0; degree <= kMaxHhDegree; ++degree) {
        const voctree::VOctree tree = random_tree(
            {.seed = degree + 20, .node_levels = kLevels[degree], .leaves = 600, .bases = 5, .hh_degree = degree});
        const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
        const render::LiveLeaves live(device(), field, field.leaf_count);
        const render::SliceTrees sliced(device(), field, render::max_entries(field), 1);
        const render::TreeSlicer slicer(device(), field, live, sliced);
        for (const float frame : {0.0f, 2.5f, 4.0f}) {
            gpu::run_once(device(), "slice",
                          [&](gpu::Commands& commands) { render::record_slice_tree(commands, slicer, 0, frame); });
            const HostTree host = download_tree(device(), field, sliced);
            const std::vector<reference::LeafSlice> truth = reference::slice_tree(tree, frame);
            TreeCheck check{host, tree, truth};
            check.visit(0, 0);
            EXPECT_LE(check.worst, 0x1p-10) << "fp16 rounds to 2^-11 of a number";
            uint32_t expected = 0;
            for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
                EXPECT_EQ(check.met[leaf], truth[leaf].sigma > 0) << "leaf " << leaf;
                expected += truth[leaf].sigma > 0;
            }
            EXPECT_GT(expected, 5u);
            EXPECT_EQ(check.entries, host.count.slots);
            EXPECT_EQ(host.count.overflow, 0u);
            EXPECT_EQ(host.count.groups_x, (host.count.slots + kSliceGroup - 1) / kSliceGroup);
        }
    }
}

TEST_F(SliceTreeTest, NodesWithoutRoomAreDeadAndCounted) {
    const voctree::VOctree tree = random_tree({.seed = 3, .node_levels = 3, .leaves = 900, .hh_degree = 1});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
    const render::LiveLeaves live(device(), field, field.leaf_count);
    const render::SliceTrees sliced(device(), field, 100, 1);
    const render::TreeSlicer slicer(device(), field, live, sliced);
    gpu::run_once(device(), "slice",
                  [&](gpu::Commands& commands) { render::record_slice_tree(commands, slicer, 0, 1); });
    const HostTree host = download_tree(device(), field, sliced);
    EXPECT_GT(host.count.overflow, 0u);
    EXPECT_GT(host.count.slots, 100u);
    for (const glm::uvec4& node : host.nodes) {
        if (!node.x && !node.y) continue;
        EXPECT_LT(node.z, 100u);
    }
}

// A ray's part inside live leaves, in metres; none (x > y) where it meets none.
glm::dvec2 met_range(const voctree::VOctree& tree, const std::vector<reference::LeafSlice>& slices,
                     const reference::Ray& ray) {
    glm::dvec2 range(1e30, -1e30);
    for (const reference::LeafInterval& interval : reference::intersect(tree, ray)) {
        if (!(slices[interval.leaf].sigma > 0)) continue;
        range = {std::min(range.x, interval.t_enter), std::max(range.y, interval.t_exit)};
    }
    return range;
}

TEST_F(SliceTreeTest, TileRangesHoldWhatTheirRaysMeetAndLittleMore) {
    constexpr uint32_t kWidth = 150, kHeight = 101, kAcross = (kWidth + 7) / 8, kDown = (kHeight + 7) / 8;
    const voctree::VOctree tree = random_tree({.seed = 12, .node_levels = 3, .leaves = 400});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
    const render::LiveLeaves live(device(), field, field.leaf_count);
    const render::SliceTrees sliced(device(), field, render::max_entries(field), 1);
    const render::TreeSlicer slicer(device(), field, live, sliced);
    const render::TileRanges ranges(device(), kAcross * kDown, kAcross * kDown, 1);
    const render::TileRanger ranger(device(), field, &sliced, ranges);
    const glm::dvec3 low(tree.box_min), size(tree.box_size);
    const std::vector<reference::LeafSlice> slices = reference::slice_tree(tree, 1);
    const auto look = [&](glm::dvec3 from, glm::dvec3 at, double focal) {
        return look_at(low + from * size, low + at * size, kWidth, kHeight, focal);
    };
    struct View {
        stage::Camera camera;
        bool outside;
        uint32_t level;  // of the finest nodes that are projected
    };
    const View outside{look({2.7, 2.4, 3.1}, glm::dvec3(0.5), 1.1), true, 2};
    View coarse = outside, whole = outside;
    coarse.level = 1;
    whole.level = 0;
    for (const auto& [camera, is_outside, level] :
         {outside, View{look({0.43, 0.57, 0.61}, {0.1, 0.2, 0.05}, 0.5), false, 2},
          View{look({0.5, 0.52, 0.98}, {0.5, 0.5, 0.3}, 0.7), false, 2},
          View{look({0.5, 0.5, 1.2}, {0.5, 0.6, 3}, 2), false, 2}, coarse, whole}) {
        gpu::run_once(device(), "ranges", [&, level = level, &camera = camera](gpu::Commands& commands) {
            *ranges.views.as<RangeView>() = render::range_view(render::shader_camera(camera));
            render::record_slice_tree(commands, slicer, 0, 1);
            render::record_clear_coverage(commands, ranges);
            render::record_tile_ranges(commands, ranger, 0, 0, level, {kWidth, kHeight});
        });
        std::vector<glm::uvec2> words(kAcross * kDown);
        LiveCount count;
        gpu::download(device(), ranges.ranges, words.data(), words.size() * sizeof(glm::uvec2));
        gpu::download(device(), ranges.count, &count, sizeof(count));
        uint32_t listed = 0, seeing = 0;
        for (uint32_t tile = 0; tile < words.size(); ++tile) {
            glm::dvec2 truth(1e30, -1e30);
            for (uint32_t i = 0; i < 64; ++i) {
                const uint32_t x = tile % kAcross * 8 + i % 8, y = tile / kAcross * 8 + i / 8;
                if (x >= kWidth || y >= kHeight) continue;
                const glm::dvec2 range = met_range(tree, slices, reference::camera_ray(camera, x, y));
                truth = {std::min(truth.x, range.x), std::max(truth.y, range.y)};
            }
            listed += words[tile].x != kNoTile;
            seeing += truth.x < truth.y;
            if (!(truth.x < truth.y)) continue;
            ASSERT_NE(words[tile].x, kNoTile) << "tile " << tile << " sees, and is not listed";
            const float near = std::bit_cast<float>(words[tile].x), far = std::bit_cast<float>(~words[tile].y);
            EXPECT_LE(near, truth.x) << "tile " << tile;
            EXPECT_GE(far, truth.y) << "tile " << tile;
        }
        EXPECT_EQ(count.slots, listed);
        EXPECT_GE(count.groups_x * count.groups_y, listed);
        if (!is_outside || level == 0) continue;
        EXPECT_LT(listed, kAcross * kDown / 2);
        EXPECT_LE(listed, 2 * seeing) << "tiles beside the leaves are few";
    }
}

TEST_F(SliceTreeTest, FarNodesAreSmallAndNothingBesideTheImageIsSeen) {
    const voctree::VOctree tree = random_tree({.seed = 12, .node_levels = 4, .leaves = 3000});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
    const auto finest = static_cast<uint32_t>(field.level_begin.size()) - 2;
    const glm::vec3 middle = 0.5f * (field.leaves_min + field.leaves_max);
    const float edge = glm::max(field.box_size.x, glm::max(field.box_size.y, field.box_size.z));
    EXPECT_EQ(render::range_level(field, middle, 100), finest);
    EXPECT_EQ(render::range_level(field, middle + glm::vec3(0, 0, 1000 * edge), 100), 0u);
    uint32_t last = finest;
    for (float away = edge; away < 1000 * edge; away *= 2) {
        const uint32_t level = render::range_level(field, middle + glm::vec3(0, 0, away), 100);
        EXPECT_LE(level, last);
        last = level;
    }
    const auto pixels = [&](glm::dvec3 eye, glm::dvec3 at) {
        return render::pixels_covered(render::range_view(render::shader_camera(look_at(eye, at, 40, 30, 1))), {40, 30},
                                      field.leaves_min, field.leaves_max);
    };
    const glm::dvec3 centre(middle), far(0, 0, 20 * edge);
    EXPECT_EQ(pixels(centre, centre + glm::dvec3(1, 0, 0)), 40 * 30) << "around the eye";
    EXPECT_GT(pixels(centre + far, centre), 1);
    EXPECT_LT(pixels(centre + far, centre), 100);
    EXPECT_EQ(pixels(centre + far, centre + 2.0 * far), 0) << "behind";
    EXPECT_EQ(pixels(centre + far, centre + glm::dvec3(30 * edge, 0, 0)), 0) << "to the left";
}

}  // namespace
}  // namespace neuvv::test
