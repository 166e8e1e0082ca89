// The rasteriser of leaves against the reference, and the order of the leaves in each tile.
#include "tools/bench/leaf_raster.h"
#include "gpu/host_copies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <unordered_map>

#include "reference/camera.h"
#include "render/volume/shade.h"
#include "render/volume/tile_range.h"
#include "render/volume/trace_tree.h"
#include "support/gpu_test.h"
#include "support/look_at.h"
#include "support/random_tree.h"

namespace neuvv::test {
namespace {

constexpr uint32_t kWidth = 45, kHeight = 35;  // not multiples of a tile's side
constexpr uint32_t kPairs = 1u << 18;
constexpr float kFrame = 1.3f;

struct Rays {
    std::vector<glm::vec4> radiance;
    std::vector<float> depth;
};

// A tree at one time, rasterised and traced.
class Drawn {
  public:
    Drawn(const gpu::Device& device, const voctree::VOctree& tree, uint32_t width, uint32_t height,
          uint32_t pairs = kPairs)
        : field(render::upload_field(device, tree, render::WeightPrecision::kFloat)),
          live(device, field, field.leaf_count),
          trees(device, field, render::max_entries(field), 2),
          shaded(render::shaded_entries(device, trees.capacity)),
          tiles(render::tiles_of_image(0, width, height)),
          target(device, 1, static_cast<uint32_t>(tiles.size()), 1),
          rays(target.rays),
          rasterizer(device, field, trees, shaded, rays, pairs),
          device_(device),
          slicer_(device, field, live, trees),
          shader_(device, field, trees, shaded),
          ranger_(device, field, &trees, target.ranges),
          tracer_(device, field, trees, shaded, target, render::Shading::kPerLeaf) {
        std::memcpy(rays.tiles.mapped, tiles.data(), tiles.size() * sizeof(Tile));
        gpu::run_once(device, "slice",
                      [&](gpu::Commands& commands) { render::record_slice_tree(commands, slicer_, kSlice, kFrame); });
    }

    Rays raster(const stage::Camera& camera, float stop, uint32_t samples = 1) {
        return draw(camera, samples, [&](gpu::Commands& commands, const ShaderCamera& seen) {
            bench::record_leaf_raster(commands, rasterizer, kSlice, seen, stop);
        });
    }

    Rays trace(const stage::Camera& camera, float stop, uint32_t samples = 1) {
        return draw(camera, samples, [&](gpu::Commands& commands, const ShaderCamera&) {
            render::record_clear(commands, rays, static_cast<uint32_t>(tiles.size()));
            render::record_clear_coverage(commands, target.ranges);
            render::record_tile_ranges(commands, ranger_, kSlice, 0, field.node_levels - 1,
                                       {camera.width, camera.height, samples});
            render::record_trace_tree(commands, tracer_, kSlice, {.stop = stop});
        });
    }

    // The leaves of a tile in the order in which they are composited.
    std::vector<std::vector<uint32_t>> leaves_of_tiles() const {
        const uint32_t sorted = bench::sorted_buffer(rasterizer.key_bits);
        std::vector<glm::uvec2> bounds(tiles.size());
        std::vector<uint32_t> entries(rasterizer.pairs.capacity), leaf_of(size_t{2} * trees.capacity);
        gpu::download(device_, rasterizer.tile_pairs, bounds.data(), bounds.size() * sizeof(glm::uvec2));
        gpu::download(device_, rasterizer.pairs.values[sorted], entries.data(), entries.size() * sizeof(uint32_t));
        gpu::download(device_, trees.entry_leaf, leaf_of.data(), leaf_of.size() * sizeof(uint32_t));
        std::vector<std::vector<uint32_t>> leaves;
        for (const glm::uvec2 pairs : bounds) {
            leaves.emplace_back();
            for (uint32_t i = pairs.x; i < pairs.y; ++i)
                leaves.back().push_back(leaf_of[trees.entry_base(kSlice) + entries[i]]);
        }
        return leaves;
    }

    static constexpr uint32_t kSlice = 1;
    const render::Field field;
    const render::LiveLeaves live;
    const render::SliceTrees trees;
    const gpu::Buffer shaded;
    const std::vector<Tile> tiles;
    render::RayTarget target;
    const render::RayBatch& rays;
    const bench::LeafRasterizer rasterizer;

  private:
    template <typename Record>
    Rays draw(const stage::Camera& camera, uint32_t samples, const Record& record) {
        const ShaderCamera seen = render::shader_camera(stage::enlarged(camera, samples), samples);
        target.set_camera(0, seen, render::range_view(seen));
        gpu::run_once(device_, "draw", [&](gpu::Commands& commands) {
            render::record_cameras(commands, target);
            render::record_shade(commands, shader_, kSlice, 0, glm::vec3(seen.origin));
            record(commands, seen);
        });
        const size_t count = tiles.size() * kTilePixels;
        Rays drawn{std::vector<glm::vec4>(count), std::vector<float>(count)};
        gpu::download(device_, rays.radiance, drawn.radiance.data(), count * sizeof(glm::vec4));
        gpu::download(device_, rays.depth, drawn.depth.data(), count * sizeof(float));
        return drawn;
    }

    const gpu::Device& device_;
    const render::TreeSlicer slicer_;
    const render::Shader shader_;
    const render::TileRanger ranger_;
    const render::TreeTracer tracer_;
};

size_t ray_of_pixel(uint32_t x, uint32_t y, uint32_t width) {
    const uint32_t across = (width + kTile - 1) / kTile;
    return (size_t{y / kTile} * across + x / kTile) * kTilePixels + y % kTile * kTile + x % kTile;
}

// Rays beyond the edges of the image are empty.
Rays shade_by_reference(const voctree::VOctree& tree, const stage::Camera& camera, size_t rays) {
    const std::vector<reference::LeafSlice> slices = reference::slice_tree(tree, kFrame);
    const std::vector<voctree::LeafPosition> places = voctree::leaf_positions(tree);
    const glm::dvec3 eye(camera.world_from_camera[3]);
    Rays truth{std::vector<glm::vec4>(rays, glm::vec4(0)), std::vector<float>(rays, INFINITY)};
    for (uint32_t y = 0; y < camera.height; ++y)
        for (uint32_t x = 0; x < camera.width; ++x) {
            const reference::Ray pixel = reference::camera_ray(camera, x, y);
            const reference::RayResult ray =
                reference::composite(reference::ray_samples_shaded(tree, slices, places, eye, pixel), 0);
            const size_t at = ray_of_pixel(x, y, camera.width);
            truth.radiance[at] = glm::vec4(glm::vec3(ray.colour), static_cast<float>(ray.alpha));
            truth.depth[at] = static_cast<float>(ray.depth_m);
        }
    return truth;
}

struct Difference {
    double light = 0;    // greatest difference of colour and alpha, linear
    double depth_m = 0;  // greatest difference where the reference has alpha
    double alpha_mean = 0;
};

void raise(double& worst, double error) {
    worst = std::isnan(error) ? INFINITY : std::max(worst, error);
}

Difference difference(const Rays& drawn, const Rays& truth) {
    Difference worst;
    for (size_t i = 0; i < truth.radiance.size(); ++i) {
        const glm::dvec4 light(drawn.radiance[i]), expected(truth.radiance[i]);
        for (int c = 0; c < 4; ++c) raise(worst.light, std::abs(light[c] - expected[c]));
        if (std::isinf(drawn.depth[i]) != (light.a == 0)) worst.depth_m = INFINITY;
        if (expected.a > 1.0 / 255) raise(worst.depth_m, std::abs(double{drawn.depth[i]} - truth.depth[i]));
        worst.alpha_mean += expected.a / static_cast<double>(truth.radiance.size());
    }
    return worst;
}

// σ and colours are fp16 with 11 significant bits, so α and sums of colours differ by up to 1/2000 of their value.
constexpr double kHalfLight = 5e-4;
// The trace reads the same numbers, so only rounding differs: positions by 1e-7 of the box, which for a ray at a slope
// of 1/100 to a face is 1e-5 m along the ray, where σ is about 30/m.
constexpr double kSameLight = 3e-4;
constexpr double kDepth_m = 1e-3;

glm::dvec3 world_of(const voctree::VOctree& tree, glm::dvec3 place) {
    return glm::dvec3(tree.box_min) + place * glm::dvec3(tree.box_size);
}

// A camera that looks along world −Z: the rays of its centre column and row lie in planes between cells.
stage::Camera axis_camera(glm::dvec3 eye) {
    stage::Camera camera = look_at(eye, eye - glm::dvec3(0, 0, 1), kWidth, kHeight);
    camera.fx = camera.fy = 64;
    return camera;
}

struct View {
    const char* name;
    stage::Camera camera;
    bool sees = true;
};

std::vector<View> views(const voctree::VOctree& tree) {
    const auto look = [&](glm::dvec3 from, glm::dvec3 at, double focal) {
        return look_at(world_of(tree, from), world_of(tree, at), kWidth, kHeight, focal);
    };
    stage::Camera off_centre = look({1.7, 1.4, 2.1}, glm::dvec3(0.5), 1.1);
    off_centre.cx += 9.25;
    off_centre.cy -= 6.5;
    return {{"outside", look({1.7, 1.4, 2.1}, glm::dvec3(0.5), 1.1)},
            {"outside, the other side", look({-0.9, -0.3, -1.3}, glm::dvec3(0.5), 1.1)},
            {"off centre", off_centre},
            {"inside", look({0.43, 0.57, 0.61}, {0.1, 0.2, 0.05}, 0.5)},
            {"before a face", look({0.48, 0.47, 1.6}, {0.5, 0.52, 0.1}, 0.9)},
            {"on the centre of all", look({0.5, 0.5, 0.5}, {0.9, 0.6, 0.2}, 0.5)},
            {"axis-parallel", axis_camera(world_of(tree, {0.371, 0.523, 1.9}))},
            {"in a plane between cells", axis_camera(world_of(tree, {0.5, 0.523, 1.9}))},
            {"behind", look({0.5, 0.5, 1.2}, {0.5, 0.6, 3}, 2), false}};
}

const RandomTreeOptions kTrees[] = {
    {.seed = 1, .node_levels = 1, .leaves = 32, .bases = 4, .hh_degree = 0},
    {.seed = 2, .node_levels = 2, .leaves = 900, .bases = 5, .hh_degree = 1},
    {.seed = 3, .node_levels = 3, .leaves = 3000, .bases = 4, .hh_degree = 2},
    {.seed = 5, .node_levels = 5, .leaves = 3000, .bases = 3, .hh_degree = 1},
    {.seed = 6, .node_levels = 6, .leaves = 6000, .bases = 3, .hh_degree = 1},
};

using LeafRasterTest = GpuTest;

TEST_F(LeafRasterTest, EveryRayIsTheReferences) {
    for (const RandomTreeOptions& options : kTrees) {
        const voctree::VOctree tree = random_tree(options);
        Drawn drawn(device(), tree, kWidth, kHeight);
        for (const View& view : views(tree)) {
            SCOPED_TRACE(std::string(view.name) + ", node levels " + std::to_string(options.node_levels));
            const Rays raster = drawn.raster(view.camera, 0);
            ASSERT_LE(bench::pair_count(device(), drawn.rasterizer), kPairs);
            const Difference found = difference(raster, shade_by_reference(tree, view.camera, raster.radiance.size()));
            EXPECT_LE(found.light, kHalfLight);
            EXPECT_LE(found.depth_m, kDepth_m);
            EXPECT_EQ(found.alpha_mean > 0.02, view.sees) << found.alpha_mean;
        }
    }
}

// Also where rays end early, and where a pixel has several rays.
TEST_F(LeafRasterTest, EveryRayIsTheTraces) {
    voctree::VOctree tree = random_tree({.seed = 3, .node_levels = 3, .leaves = 3000});
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
        for (uint32_t c = 0; c < tree.bases; ++c) tree.leaf(leaf)[c] *= 12;
    for (const uint32_t samples : {1u, 3u}) {
        Drawn drawn(device(), tree, samples * kWidth, samples * kHeight);
        for (const View& view : views(tree)) {
            SCOPED_TRACE(view.name);
            const Rays trace = drawn.trace(view.camera, render::kStopTransmittance, samples);
            const Difference found = difference(drawn.raster(view.camera, render::kStopTransmittance, samples), trace);
            EXPECT_LE(found.light, kSameLight);
            EXPECT_LE(found.depth_m, kDepth_m);
        }
    }
}

// The list of a tile has all leaves that its rays meet, near to far along every ray.
TEST_F(LeafRasterTest, TilesHaveTheirLeavesFrontToBack) {
    for (const RandomTreeOptions& options : kTrees) {
        const voctree::VOctree tree = random_tree(options);
        Drawn drawn(device(), tree, kWidth, kHeight);
        const std::vector<reference::LeafSlice> slices = reference::slice_tree(tree, kFrame);
        for (const View& view : views(tree)) {
            SCOPED_TRACE(std::string(view.name) + ", node levels " + std::to_string(options.node_levels));
            drawn.raster(view.camera, 0);
            std::vector<std::unordered_map<uint32_t, size_t>> rank_of_leaf;
            for (const std::vector<uint32_t>& leaves : drawn.leaves_of_tiles()) {
                rank_of_leaf.emplace_back();
                for (const uint32_t leaf : leaves) {
                    const size_t rank = rank_of_leaf.back().size();
                    EXPECT_TRUE(rank_of_leaf.back().emplace(leaf, rank).second) << "leaf " << leaf << " twice";
                }
            }
            size_t met = 0;
            for (uint32_t y = 0; y < kHeight; ++y)
                for (uint32_t x = 0; x < kWidth; ++x) {
                    const auto& ranks = rank_of_leaf[ray_of_pixel(x, y, kWidth) / kTilePixels];
                    size_t next = 0;
                    for (const reference::LeafInterval& part :
                         reference::intersect(tree, reference::camera_ray(view.camera, x, y))) {
                        // A shorter part of a ray is at a corner, which rounding may leave out, or in a plane in which
                        // the ray lies.
                        if (!(slices[part.leaf].sigma > 0) || part.t_exit - part.t_enter < 1e-5) continue;
                        const auto found = ranks.find(part.leaf);
                        ASSERT_NE(found, ranks.end()) << "a leaf is missing at " << x << ' ' << y;
                        EXPECT_GE(found->second, next) << "a leaf is behind a farther one at " << x << ' ' << y;
                        next = found->second + 1;
                        ++met;
                    }
                }
            EXPECT_EQ(met > 100, view.sees);
        }
    }
}

TEST_F(LeafRasterTest, PairsWithoutRoomAreCounted) {
    const voctree::VOctree tree = random_tree(kTrees[1]);
    const stage::Camera camera = views(tree)[0].camera;
    Drawn all(device(), tree, kWidth, kHeight), some(device(), tree, kWidth, kHeight, 50);
    const Rays truth = all.raster(camera, 0), part = some.raster(camera, 0);
    const uint32_t wanted = bench::pair_count(device(), all.rasterizer);
    EXPECT_GT(wanted, 50u);
    EXPECT_EQ(bench::pair_count(device(), some.rasterizer), wanted);
    EXPECT_GT(difference(part, truth).light, 0.1) << "as if nothing were missing";
    Drawn fitting(device(), tree, kWidth, kHeight, wanted);
    EXPECT_EQ(fitting.raster(camera, 0).radiance, truth.radiance);
}

TEST(LeafRasterComparison, NoticesOneWrongRay) {
    const Rays truth{std::vector<glm::vec4>(9, glm::vec4(0.2f, 0.3f, 0.4f, 0.5f)), std::vector<float>(9, 2.0f)};
    EXPECT_EQ(difference(truth, truth).light, 0);
    Rays wrong = truth;
    wrong.radiance[4].b += 0.001f;
    EXPECT_GT(difference(wrong, truth).light, kHalfLight);
    wrong = truth;
    wrong.depth[3] = NAN;
    EXPECT_FALSE(difference(wrong, truth).depth_m <= kDepth_m);
}

}  // namespace
}  // namespace neuvv::test
