// The intermediate buffers of a frame as images: their sizes, and what their numbers mean.
#include "render/frame/frame_passes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "support/gpu_test.h"
#include "support/look_at.h"
#include "support/random_tree.h"
#include "support/set_scene.h"

namespace neuvv::test::frame_passes_test {
namespace {

using FramePassesTest = GpuTest;

constexpr uint32_t kWidth = 61, kHeight = 43, kSamples = 2;
constexpr uint32_t kAcross = kSamples * kWidth, kDown = kSamples * kHeight;  // rays
constexpr uint32_t kTilesAcross = (kAcross + kTile - 1) / kTile, kTilesDown = (kDown + kTile - 1) / kTile;

render::SetLight lamp() {
    render::SetLight light;
    light.kind = render::SetLightKind::kSpot;
    light.position = {0.5, 5, 0.4};
    light.direction = {0, -1, 0};
    light.colour = {100, 100, 100};
    light.inner_cos = std::cos(0.6);
    light.outer_cos = std::cos(0.7);
    light.casts_shadow = true;
    return light;
}

// A floor, a wall of glass in front, and a performer between them under a lamp that casts shadows.
struct Scene {
    voctree::VOctree tree = random_tree({.seed = 3, .node_levels = 3, .leaves = 2500});
    render::Field field;
    stage::GltfScene gltf;
    render::SetRaster set;
    render::FrameRenderer frames;
    stage::Camera camera = look_at({0.3, 2, 4}, {0, 0.3, 0}, kWidth, kHeight, 1.1);

    static GlbBuilder built() {
        GlbBuilder glb;
        add_mesh(glb, rectangle({-4, -1, 4}, {8, 0, 0}, {0, 0, -8}), pbr_material({0.8f, 0.8f, 0.8f, 1}, 0, 1));
        json glass = pbr_material({1, 0, 0, 0.5f}, 0, 1);
        glass["alphaMode"] = "BLEND";
        add_mesh(glb, rectangle({-4, -4, 3}, {8, 0, 0}, {0, 8, 0}), glass);
        return glb;
    }

    explicit Scene(const gpu::Device& device)
        : field(render::upload_field(device, tree, render::WeightPrecision::kHalf)),
          gltf(scene_of(built())),
          set(device, gltf, kAcross, kDown, 1),
          frames(device, {&field}, {kWidth, kHeight, kSamples}, &set) {
        set.pose(stage::pose_scene(gltf, stage::kNoAnimation, 0));
        const render::SetLight light = lamp();
        set.lighting.light(std::span(&light, 1), {glm::dvec3(0.2)}, {true, true});
        render::FrameSettings settings;
        settings.width = kWidth;
        settings.height = kHeight;
        settings.samples = kSamples;
        frames.render(camera, settings);
    }

    render::PassValues read(const char* name) const { return render::find_frame_pass(name)->read(frames); }
};

size_t numbers_in(const render::PassValues& pass) {
    size_t count = 0;
    for (const float value : pass.values) count += !std::isnan(value);
    return count;
}

TEST_F(FramePassesTest, EachHasItsNameAndASizeThatFits) {
    const Scene scene(device());
    std::set<std::string> names;
    for (const render::FramePass& pass : render::frame_passes()) {
        SCOPED_TRACE(pass.name);
        EXPECT_TRUE(names.insert(pass.name).second);
        EXPECT_EQ(render::find_frame_pass(pass.name), &pass);
        const render::PassValues values = pass.read(scene.frames);
        ASSERT_EQ(values.values.size(), size_t{values.width} * values.height);
        const auto range = render::range_of(values);
        ASSERT_TRUE(range) << "this scene has something in every buffer";
        const media::Image image = render::colour_mapped(values, *range);
        EXPECT_EQ(image.width, values.width);
        EXPECT_EQ(image.height, values.height);
    }
    EXPECT_EQ(render::find_frame_pass("soup"), nullptr);
}

TEST_F(FramePassesTest, RaysHaveWhatTheRendererSays) {
    const Scene scene(device());
    const std::vector<glm::vec4> radiance = scene.frames.radiance();
    const std::vector<float> depth = scene.frames.depth();
    const render::PassValues metres = scene.read("depth"), alpha = scene.read("alpha"), light = scene.read("radiance");
    for (const render::PassValues* pass : {&metres, &alpha, &light}) {
        ASSERT_EQ(pass->width, kAcross);
        ASSERT_EQ(pass->height, kDown);
    }
    size_t covered = 0;
    for (size_t i = 0; i < depth.size(); ++i) {
        EXPECT_EQ(alpha.values[i], radiance[i].a);
        EXPECT_NEAR(light.values[i], 0.2126f * radiance[i].r + 0.7152f * radiance[i].g + 0.0722f * radiance[i].b, 1e-6);
        EXPECT_EQ(std::isnan(metres.values[i]), std::isinf(depth[i]));
        if (std::isinf(depth[i])) continue;
        EXPECT_EQ(metres.values[i], depth[i]);
        ++covered;
    }
    EXPECT_GT(covered, 100u);
    EXPECT_LT(covered, depth.size());
}

// The bounds of a tile contain the depths of its rays; the tiles that have bounds are those that are listed and
// covered.
TEST_F(FramePassesTest, TilesBoundTheirRays) {
    const Scene scene(device());
    const render::PassValues near = scene.read("tile-near"), far = scene.read("tile-far");
    const render::PassValues list = scene.read("tile-list"), covered = scene.read("tiles-seen");
    const std::vector<float> depth = scene.frames.depth();
    ASSERT_EQ(near.width, kTilesAcross);
    ASSERT_EQ(near.height, kTilesDown);
    size_t rays = 0;
    for (uint32_t y = 0; y < kDown; ++y)
        for (uint32_t x = 0; x < kAcross; ++x) {
            const size_t tile = y / kTile * kTilesAcross + x / kTile;
            if (std::isinf(depth[size_t{y} * kAcross + x])) continue;
            ++rays;
            EXPECT_GE(depth[size_t{y} * kAcross + x], near.values[tile] - 1e-3f);
            EXPECT_LE(depth[size_t{y} * kAcross + x], far.values[tile] + 1e-3f);
        }
    EXPECT_GT(rays, 100u);
    std::set<float> indices;
    for (size_t tile = 0; tile < near.values.size(); ++tile) {
        const bool bounded = !std::isnan(near.values[tile]);
        EXPECT_EQ(std::isnan(far.values[tile]), !bounded);
        EXPECT_EQ(std::isnan(list.values[tile]), !bounded);
        EXPECT_EQ(covered.values[tile], bounded ? 1 : 0);
        if (bounded) indices.insert(list.values[tile]);
    }
    EXPECT_EQ(indices.size(), numbers_in(near)) << "each tile has an index of its own";
    EXPECT_EQ(*indices.rbegin(), static_cast<float>(indices.size() - 1));
    EXPECT_LT(indices.size(), near.values.size());
}

TEST_F(FramePassesTest, TheSetIsWhereItStands) {
    const Scene scene(device());
    const render::PassValues metres = scene.read("set-depth"), volume = scene.read("volume-depth");
    ASSERT_EQ(metres.width, kAcross);
    const stage::Camera rays = stage::enlarged(scene.camera, kSamples);
    const glm::dmat4 world = scene.camera.world_from_camera;
    size_t on_floor = 0;
    for (uint32_t y = 0; y < kDown; ++y)
        for (uint32_t x = 0; x < kAcross; ++x) {
            const glm::dvec3 line((x + 0.5 - rays.cx) / rays.fx, (rays.cy - y - 0.5) / rays.fy, -1);
            const glm::dvec3 along = glm::dmat3(world) * line, eye(world[3]);
            const double axis_m = (-1 - eye.y) / along.y;  // to the floor's plane
            const glm::dvec3 at = eye + axis_m * along;
            if (axis_m <= 0 || std::abs(at.x) > 3.9 || std::abs(at.z) > 3.9) continue;
            ++on_floor;
            EXPECT_NEAR(metres.values[size_t{y} * kAcross + x], axis_m, 2e-2 * axis_m) << x << ' ' << y;
        }
    EXPECT_GT(on_floor, 500u);
    EXPECT_GT(numbers_in(volume), 100u);
    EXPECT_LT(numbers_in(volume), volume.values.size());
}

TEST_F(FramePassesTest, ShadowMapsAreWhatTheLampSees) {
    const Scene scene(device());
    const render::PassValues alpha = scene.read("performer-shadow-alpha"),
                             metres = scene.read("performer-shadow-depth");
    const render::PassValues floor = scene.read("set-shadow");
    EXPECT_EQ(alpha.width, kPerformerShadowSide) << "one light casts a shadow";
    EXPECT_EQ(floor.width, kSetShadowSide);
    const auto shares = *render::range_of(alpha), distances = *render::range_of(metres);
    EXPECT_GE(shares.first, 0);
    EXPECT_GT(shares.second, 0.1f);
    EXPECT_LE(shares.second, 1);
    const double nearest = 5 - (scene.field.leaves_max.y), farthest = 2.5 + 5 - scene.field.leaves_min.y;
    EXPECT_GT(distances.first, 0.9 * nearest);
    EXPECT_LT(distances.second, farthest);
    EXPECT_GT(numbers_in(floor), floor.values.size() / 10);
}

TEST(FramePasses, ColoursGoFromDarkToBrightAndNothingIsClear) {
    const render::PassValues values{3, 1, {2, NAN, 4}};
    const auto range = render::range_of(values);
    ASSERT_EQ(range, (std::pair(2.0f, 4.0f)));
    const media::Image image = render::colour_mapped(values, *range);
    const auto brightness = [&](uint32_t x) { return image.at(x, 0)[0] + image.at(x, 0)[1] + image.at(x, 0)[2]; };
    EXPECT_LT(brightness(0) + 200, brightness(2));
    EXPECT_EQ(image.at(0, 0)[3], 255);
    EXPECT_EQ(image.at(1, 0)[3], 0);
    EXPECT_FALSE(render::range_of({1, 1, {NAN}}));
}

}  // namespace
}  // namespace neuvv::test::frame_passes_test
