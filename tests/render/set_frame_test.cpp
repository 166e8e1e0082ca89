// Performers on a set: rays end at it, light and shadow fall on both, glass stands before and behind.
#include <gtest/gtest.h>

#include <numbers>

#include "base/error.h"
#include "reference/camera.h"
#include "reference/lights.h"
#include "reference/trace.h"
#include "render/frame/frame_renderer.h"
#include "support/gpu_test.h"
#include "support/look_at.h"
#include "support/random_tree.h"
#include "support/set_scene.h"
#include "support/traced.h"
#include "support/waver_tree.h"

namespace neuvv::test::set_frame_test {
namespace {

using SetFrameTest = GpuTest;

constexpr uint32_t kWidth = 61, kHeight = 43;

json unlit(glm::vec4 colour) {
    return {{"pbrMetallicRoughness", {{"baseColorFactor", {colour.r, colour.g, colour.b, colour.a}}}},
            {"extensions", {{"KHR_materials_unlit", json::object()}}},
            {"doubleSided", true}};
}

// An upright wall across the view at depth z, wider than any image.
MeshData wall_at(float z) {
    return rectangle({-20, -20, z}, {40, 0, 0}, {0, 40, 0});
}

stage::Camera camera_before() {
    return look_at({0.3, 0.9, 4}, {0, 0.4, 0}, kWidth, kHeight, 1.1);
}

std::vector<reference::Sample> cut_at(const std::vector<reference::Sample>& samples, double end_m) {
    std::vector<reference::Sample> before;
    for (reference::Sample sample : samples) {
        const double first = sample.z_m - 0.5 * sample.delta_m, last = std::min(first + sample.delta_m, end_m);
        if (last <= first) continue;
        sample.delta_m = last - first;
        sample.z_m = 0.5 * (first + last);
        before.push_back(sample);
    }
    return before;
}

// A set with the renderer that draws performers on it.
struct OnSet {
    stage::GltfScene scene;
    render::SetRaster set;
    render::FrameRenderer frames;
    OnSet(const gpu::Device& device, const GlbBuilder& glb, const std::vector<const render::Field*>& fields,
          const render::FrameCapacity& capacity)
        : scene(scene_of(glb)),
          set(device, scene, capacity.samples * capacity.width, capacity.samples * capacity.height, capacity.views),
          frames(device, fields, capacity, &set) {
        set.pose(stage::pose_scene(scene, stage::kNoAnimation, 0));
    }
};

render::FrameSettings settings_of(std::vector<render::Instance> instances, uint32_t samples = 1) {
    render::FrameSettings settings;
    settings.instances = std::move(instances);
    settings.width = kWidth;
    settings.height = kHeight;
    settings.samples = samples;
    settings.stop = 0;
    settings.lit = false;
    return settings;
}

// A wall through the centre of a performer ends the rays there, and is visible through the performer.
TEST_F(SetFrameTest, RaysEndAtTheSetAndTheSetIsBehindThem) {
    const voctree::VOctree tree =
        random_tree({.seed = 3, .node_levels = 3, .leaves = 1500, .bases = 5, .hh_degree = 2});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const std::vector<reference::LeafSlice> slices = reference::slice_tree(tree, 1);
    const stage::Camera camera = camera_before();
    constexpr double kWall = 0.15;
    GlbBuilder glb;
    add_mesh(glb, wall_at(static_cast<float>(kWall)), unlit({0.2f, 0.5f, 0.1f, 1}));
    for (const uint64_t budget : {render::kSliceBudget, uint64_t{0}}) {
        SCOPED_TRACE("slice budget " + std::to_string(budget));
        OnSet stage(device(), glb, {&field}, {kWidth, kHeight, 1, 1, budget});
        const media::Image image = stage.frames.render(camera, settings_of({{1}}));
        Traced truth;
        double worst = 0;
        for (uint32_t y = 0; y < kHeight; ++y)
            for (uint32_t x = 0; x < kWidth; ++x) {
                const reference::Ray ray = reference::camera_ray(camera, x, y);
                const double end = (kWall - ray.origin.z) / ray.direction.z;
                const reference::RayResult light =
                    reference::composite(cut_at(reference::ray_samples(tree, slices, ray), end));
                truth.radiance.emplace_back(glm::vec3(light.colour), static_cast<float>(light.alpha));
                truth.depth.push_back(static_cast<float>(light.depth_m));
                const glm::dvec3 rendered = light.colour + (1 - light.alpha) * glm::dvec3(0.2, 0.5, 0.1);
                for (int c = 0; c < 3; ++c)
                    raise(worst, std::abs(255 * reference::display_value(rendered[c]) - image.at(x, y)[c]));
                EXPECT_EQ(image.at(x, y)[3], 255);
            }
        const Difference found = difference({stage.frames.radiance(), stage.frames.depth()}, truth);
        EXPECT_LE(found.steps, kHalfSteps);
        EXPECT_LE(found.depth_m, 5 * kDepth_m);
        EXPECT_GT(found.alpha_mean, 0.05);
        EXPECT_LE(worst, 0.5 + kHalfSteps + 0.3) << "rounding to bytes, slices and the set's colours as fp16";
    }
}

// A set far behind the performer does not change its rays; a set before it hides it completely.
TEST_F(SetFrameTest, WhatIsBehindTheSetIsNotThere) {
    const voctree::VOctree tree = random_tree({.seed = 3, .node_levels = 3, .leaves = 1500});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    render::FrameRenderer alone(device(), field, {kWidth, kHeight, 2});
    alone.render(camera_before(), settings_of({{1}}, 2));
    for (const float z : {-9.0f, 3.0f}) {
        GlbBuilder glb;
        add_mesh(glb, wall_at(z), unlit({1, 1, 1, 1}));
        OnSet stage(device(), glb, {&field}, {kWidth, kHeight, 2});
        const media::Image image = stage.frames.render(camera_before(), settings_of({{1}}, 2));
        if (z < 0) {
            EXPECT_EQ(stage.frames.radiance(), alone.radiance());
        } else {
            for (const glm::vec4& ray : stage.frames.radiance()) EXPECT_EQ(ray.a, 0);
            for (const uint8_t byte : image.rgba) EXPECT_EQ(byte, 255);
        }
    }
}

// Several samples a pixel, both eyes, and fewer rays than pixels show the same set with the same performer.
TEST_F(SetFrameTest, ViewsSamplesAndScalesAgree) {
    const voctree::VOctree tree = random_tree({.seed = 4, .node_levels = 3, .leaves = 2000});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    GlbBuilder glb;
    add_mesh(glb, wall_at(0.1f), unlit({0.4f, 0.1f, 0.2f, 1}));
    const stage::Camera eyes[] = {camera_before(), look_at({0.9, 0.6, 4}, {0, 0.4, 0}, kWidth, kHeight, 1.1)};
    OnSet both(device(), glb, {&field}, {kWidth, kHeight, 1, 2}), one(device(), glb, {&field}, {kWidth, kHeight});
    const std::vector<media::Image> images = both.frames.render_views(eyes, settings_of({{1}}));
    for (size_t view = 0; view < 2; ++view)
        EXPECT_EQ(images[view].rgba, one.frames.render(eyes[view], settings_of({{1}})).rgba) << "view " << view;
    render::FrameSettings coarse = settings_of({{1}});
    coarse.scale = 0.6;
    const media::Image scaled = one.frames.render(eyes[0], coarse);
    double mean = 0;
    for (size_t i = 0; i < scaled.rgba.size(); ++i)
        mean += std::abs(scaled.rgba[i] - images[0].rgba[i]) / static_cast<double>(scaled.rgba.size());
    EXPECT_LT(mean, 6) << "random leaves are all edges";
    EXPECT_GT(mean, 0);
}

// A cube of density around (0, 0.5, 0), one metre high, of 4^levels leaves along each side.
voctree::VOctree cube(float sigma, uint32_t levels = 1) {
    const uint32_t side = 1u << (2 * levels);
    voctree::VOctree tree;
    tree.box_min = {-0.5f, 0, -0.5f};
    tree.box_size = {1, 1, 1};
    tree.node_levels = levels;
    tree.bases = tree.frames = 1;
    tree.hh_degree = 0;
    tree.sigma_basis = {1};
    tree.gamma_basis = {0};
    std::vector<voctree::LeafPosition> positions;
    for (uint32_t i = 0; i < side * side * side; ++i)
        positions.push_back({i % side, i / side % side, i / side / side, 2 * levels});
    voctree::build_topology(tree, positions);
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) tree.leaf(leaf)[0] = sigma;
    return tree;
}

render::SetLight lamp(glm::dvec3 at, glm::dvec3 towards, double candela) {
    render::SetLight light;
    light.kind = render::SetLightKind::kSpot;
    light.position = at;
    light.direction = glm::normalize(towards - at);
    light.colour = candela * glm::dvec3(1, 0.8, 0.6);
    light.inner_cos = std::cos(0.5);
    light.outer_cos = std::cos(0.6);
    light.casts_shadow = true;
    return light;
}

MeshData floor_mesh() {
    return rectangle({-4, 0, 4}, {8, 0, 0}, {0, 0, -8});
}

// On the floor behind a translucent cube, the light that arrives is what the cube lets through along the line to the
// lamp.
TEST_F(SetFrameTest, APerformersShadowIsItsAlphaAlongTheLight) {
    const voctree::VOctree tree = cube(1.2f);
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const std::vector<reference::LeafSlice> slices = reference::slice_tree(tree, 0);
    GlbBuilder glb;
    add_mesh(glb, floor_mesh(), pbr_material({0.8f, 0.8f, 0.8f, 1}, 0, 1));
    constexpr uint32_t kSide = 128;
    OnSet stage(device(), glb, {&field}, {kSide, kSide});
    const render::SetLight light = lamp({0.5, 4, 0.4}, {0, 0, 0}, 100);
    const stage::Camera camera = look_at({0, 5, 0.01}, {0, 0, 0}, kSide, kSide, 1.2);
    const glm::mat4 lifted = glm::mat4({1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0.8f, 0, 1});
    const auto light_with = [&](bool shadows, bool casts) {
        stage.set.lighting.light(std::span(&light, 1), {}, {shadows, shadows});
        render::FrameSettings settings = settings_of({{0, lifted}});
        settings.width = settings.height = kSide;
        settings.instances[0].casts_shadow = casts;
        stage.frames.render(camera, settings);
        std::vector<double> rendered;
        for (const glm::dvec4& texel : download_colours(device(), stage.set.targets().colour))
            rendered.push_back(texel.g);
        return rendered;
    };
    const std::vector<double> lit = light_with(false, true), shadowed = light_with(true, true);
    const std::vector<double> no_casters = light_with(true, false);
    for (size_t i = 0; i < lit.size(); ++i) ASSERT_NEAR(no_casters[i], lit[i], 1e-3) << "its map is empty";
    uint32_t inside = 0, outside = 0;
    for (uint32_t y = 0; y < kSide; ++y)
        for (uint32_t x = 0; x < kSide; ++x) {
            const reference::Ray eye = reference::camera_ray(camera, x, y);
            const glm::dvec3 point = eye.origin - eye.origin.y / eye.direction.y * eye.direction;
            if (lit[y * kSide + x] < 0.05) continue;  // outside the cone
            // Alpha along the line, and how much it changes over the radius of the filter.
            const auto alpha_at = [&](glm::dvec3 at) {
                reference::Ray ray{light.position - glm::dvec3(0, 0.8, 0), glm::normalize(at - light.position)};
                return reference::trace(tree, slices, ray).alpha;
            };
            double low = 1, high = 0;
            for (int i = 0; i < 16; ++i) {
                const double angle = std::numbers::pi / 8 * i;
                const double alpha = alpha_at(point + 0.28 * glm::dvec3(std::cos(angle), 0, std::sin(angle)));
                low = std::min(low, alpha);
                high = std::max(high, alpha);
            }
            if (high - low > 0.02) continue;  // in the penumbra
            const double through = shadowed[y * kSide + x] / lit[y * kSide + x];
            EXPECT_NEAR(through, 1 - alpha_at(point), 0.025) << x << ", " << y;
            (alpha_at(point) > 0.3 ? inside : outside)++;
        }
    EXPECT_GT(inside, 100u);
    EXPECT_GT(outside, 500u);
}

// The brightness of a solid performer under a lamp: candela / (π d²) at the depth where rays see it.
TEST_F(SetFrameTest, LightFallsOffWithTheDistanceFromTheLamp) {
    const voctree::VOctree tree = cube(400);
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    GlbBuilder glb;
    add_mesh(glb, floor_mesh(), pbr_material({0.8f, 0.8f, 0.8f, 1}, 0, 1));
    OnSet stage(device(), glb, {&field}, {kWidth, kHeight});
    const stage::Camera camera = look_at({0.5, 1.2, 3}, {0, 0.5, 0}, kWidth, kHeight, 1.4);
    const render::SetLight light = lamp({0.4, 2.5, 1}, {0, 0.5, 0}, 20);
    const render::SetAmbient ambient{.light = {0.05, 0.1, 0.02}};
    stage.set.lighting.light(std::span(&light, 1), ambient, {false, false});
    render::FrameSettings settings = settings_of({{0}});
    stage.frames.render(camera, settings);
    const std::vector<glm::vec4> captured = stage.frames.radiance();
    settings.lit = true;
    for (const bool merged : {false, true}) {
        settings.instances.resize(merged ? 2 : 1);
        if (merged) settings.instances[1].world_from_performer[3] = {0.8f, -0.4f, -0.6f, 1};  // overlaps it
        stage.frames.render(camera, settings);
        const std::vector<glm::vec4> rendered = stage.frames.radiance();
        const std::vector<float> depth = stage.frames.depth();
        uint32_t compared = 0;
        double least = INFINITY, most = 0;
        for (uint32_t i = 0; i < rendered.size(); ++i) {
            if (captured[i].a < 0.999f || (merged && std::abs(rendered[i].a - captured[i].a) > 1e-4f)) continue;
            const reference::Ray ray = reference::camera_ray(camera, i % kWidth, i / kWidth);
            glm::dvec3 to_light;
            const glm::dvec3 arriving =
                reference::light_at(light, ray.origin + static_cast<double>(depth[i]) * ray.direction, to_light);
            const glm::dvec3 expected = glm::dvec3(captured[i]) * (ambient.light + arriving / std::numbers::pi);
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(static_cast<double>(rendered[i][c]), expected[c], 0.004 * expected.g + 1e-6)
                    << "ray " << i << (merged ? ", light in nine bits" : "");
            least = std::min(least, expected.g);
            most = std::max(most, expected.g);
            ++compared;
        }
        EXPECT_GT(compared, 100u);
        EXPECT_GT(most, 1.5 * least) << "head and feet";
    }
}

// The set casts its shadow on performers, too, except on a performer that receives no shadow.
TEST_F(SetFrameTest, TheSetShadowsPerformers) {
    const voctree::VOctree tree = cube(400);
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    GlbBuilder glb;
    json roof = unlit({1, 1, 1, 1});
    add_mesh(glb, rectangle({-3, 2, 3}, {3, 0, 0}, {0, 0, -6}), roof);  // over all x < 0
    OnSet stage(device(), glb, {&field}, {kWidth, kHeight});
    const stage::Camera camera = look_at({0, 0.6, 3}, {0, 0.5, 0}, kWidth, kHeight, 1.4);
    const render::SetLight light = lamp({0, 5, 0}, {0, 0, 0}, 60);
    render::FrameSettings settings = settings_of({{0}});
    settings.lit = true;
    settings.instances[0].casts_shadow = false;
    const auto rendered = [&](bool shadows, bool receives) {
        stage.set.lighting.light(std::span(&light, 1), {}, {shadows, shadows});
        settings.instances[0].receives_shadow = receives;
        stage.frames.render(camera, settings);
        return stage.frames.radiance();
    };
    const std::vector<glm::vec4> lit = rendered(false, true), shadowed = rendered(true, true);
    EXPECT_EQ(lit, rendered(true, false));
    const size_t row = size_t{kHeight / 2} * kWidth;
    EXPECT_GT(lit[row + kWidth / 2 - 5].g, 0.1f);
    EXPECT_EQ(shadowed[row + kWidth / 2 - 5].g, 0) << "below the roof";
    EXPECT_EQ(shadowed[row + kWidth / 2 + 5].g, lit[row + kWidth / 2 + 5].g) << "beside it";
}

// Shadow maps are cleared only where the last frame's performers may have been.
TEST_F(SetFrameTest, NothingOfTheLastShadowStays) {
    const voctree::VOctree tree = cube(1.2f);
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    GlbBuilder glb;
    add_mesh(glb, floor_mesh(), pbr_material({0.8f, 0.8f, 0.8f, 1}, 0, 1));
    const render::SetLight lights[] = {lamp({0.5, 4, 0.4}, {0, 0, 0}, 100), lamp({-2, 4, 1}, {0, 0, 0}, 60)};
    const stage::Camera camera = look_at({0, 5, 0.01}, {0, 0, 0}, kWidth, kHeight, 1.2);
    const auto drawn = [&](OnSet& stage, float x, size_t count) {
        stage.set.lighting.light(std::span(lights).first(count), {}, {true, true});
        render::FrameSettings settings = settings_of({{0}});
        settings.instances[0].world_from_performer[3] = {x, 0.8f, 0, 1};
        stage.frames.render(camera, settings);
        return download_colours(device(), stage.set.targets().colour);
    };
    OnSet reused(device(), glb, {&field}, {kWidth, kHeight});
    std::vector<glm::dvec4> last;
    for (const auto& [x, count] : {std::pair(-0.8f, size_t{1}), {0.8f, 1}, {0.8f, 2}, {-0.4f, 2}, {0.4f, 1}}) {
        OnSet fresh(device(), glb, {&field}, {kWidth, kHeight});
        const std::vector<glm::dvec4> colours = drawn(reused, x, count);
        EXPECT_EQ(colours, drawn(fresh, x, count));
        EXPECT_NE(colours, last);
        last = colours;
    }
}

// The shadow of a lit cube falls on another cube behind it; the cube nearer to the lamp stays lit.
TEST_F(SetFrameTest, PerformersShadowEachOther) {
    const voctree::VOctree tree = cube(400, 3);  // a sample's depth is its leaf's centre
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    GlbBuilder glb;
    add_mesh(glb, wall_at(-9), unlit({0, 0, 0, 1}));
    OnSet stage(device(), glb, {&field}, {kWidth, kHeight});
    const stage::Camera camera = look_at({0, 1.3, 6}, {0, 1, 0}, kWidth, kHeight, 1.6);
    render::SetLight sun = lamp({0, 6, 4}, {0, 1, 0}, 3);
    sun.kind = render::SetLightKind::kDirectional;
    render::FrameSettings settings = settings_of({{0}, {0}});
    settings.instances[1].world_from_performer[3] = {0, 1.3f, 1.3f, 1};  // between the lamp and the other cube
    settings.lit = true;
    for (const render::SetLight& light : {lamp({0, 6, 4}, {0, 1, 0}, 60), sun}) {
        SCOPED_TRACE(static_cast<int>(light.kind));
        const auto rendered = [&](bool shadows) {
            stage.set.lighting.light(std::span(&light, 1), {}, {shadows, shadows});
            stage.frames.render(camera, settings);
            return stage.frames.radiance();
        };
        const std::vector<glm::vec4> lit = rendered(false), shadowed = rendered(true);
        double above = 0, below = 0, above_lit = 0, below_lit = 0;
        for (uint32_t i = 0; i < lit.size(); ++i) {
            const reference::Ray ray = reference::camera_ray(camera, i % kWidth, i / kWidth);
            const double height = ray.origin.y + (0.5 - ray.origin.z) / ray.direction.z * ray.direction.y;
            if (lit[i].a < 0.99f) continue;
            (height > 1.15 ? above : below) += static_cast<double>(shadowed[i].g);
            (height > 1.15 ? above_lit : below_lit) += static_cast<double>(lit[i].g);
        }
        EXPECT_GT(above, 0.85 * above_lit) << "of its own it keeps out of";
        EXPECT_LT(below, 0.35 * below_lit);
        EXPECT_GT(below_lit, 0);
    }
}

// The map of a directional light covers all performers: the shadow of a near one must not move where another performer,
// which is far away, is drawn from larger leaves.
TEST_F(SetFrameTest, FarLevelsDoNotMoveShadowMaps) {
    const render::Field field = render::upload_far_levels(device(), waver_tree());
    GlbBuilder glb;
    add_mesh(glb, floor_mesh(), pbr_material({0.8f, 0.8f, 0.8f, 1}, 0, 1));
    OnSet stage(device(), glb, {&field}, {kWidth, kHeight});
    render::SetLight sun = lamp({1, 4, 2}, {0, 0, 0}, 3);
    sun.kind = render::SetLightKind::kDirectional;
    stage.set.lighting.light(std::span(&sun, 1), {});
    const glm::mat4 far({1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {1, 0, -30, 1});
    render::FrameSettings settings = settings_of({{0}, {0, far}});
    const stage::Camera camera = look_at({0, 2, 3}, {0, 1.2, 0}, kWidth, kHeight, 1.1);
    const auto light_with = [&](bool far_levels) {
        settings.far_levels = far_levels;
        stage.frames.render(camera, settings);
        return std::pair(stage.set.lighting.lights().light[0].performer_clip_from_world,
                         download_colours(device(), stage.set.targets().colour));
    };
    const auto [map, colours] = light_with(true);
    bool any_coarser = false, any_finest = false;
    for (const auto& group : stage.frames.plan().drawn)
        for (const render::DrawnInstance& one : group) (one.field > 0 ? any_coarser : any_finest) = true;
    EXPECT_TRUE(any_coarser && any_finest);
    const auto [map_without, colours_without] = light_with(false);
    EXPECT_EQ(map, map_without);
    for (size_t i = 0; i < colours.size(); ++i) ASSERT_NEAR(colours[i].g, colours_without[i].g, 1e-3) << i;
}

// Red glass before a performer, green glass behind it.
TEST_F(SetFrameTest, GlassStandsBeforeAndBehind) {
    const voctree::VOctree tree = cube(400);
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    GlbBuilder glb;
    add_mesh(glb, wall_at(-5), unlit({0, 0, 1, 1}));
    const auto glass = [](glm::vec4 colour) {
        json material = unlit(colour);
        material["alphaMode"] = "BLEND";
        return material;
    };
    add_mesh(glb, wall_at(2), glass({1, 0, 0, 0.5f}));
    add_mesh(glb, wall_at(-2), glass({0, 1, 0, 0.5f}));
    OnSet stage(device(), glb, {&field}, {kWidth, kHeight});
    const stage::Camera camera = look_at({0, 0.5, 5}, {0, 0.5, 0}, kWidth, kHeight, 1);
    const media::Image image = stage.frames.render(camera, settings_of({{0}}));
    const uint8_t* on = image.at(kWidth / 2, kHeight / 2);
    const uint8_t* beside = image.at(2, 2);
    const auto byte = [](double linear) { return std::round(255 * media::srgb_from_linear(linear)); };
    // The cube's own colour is grey: sigmoid(0).
    EXPECT_NEAR(on[0], byte(0.5 + 0.5 * 0.5), 1);
    EXPECT_NEAR(on[1], byte(0.5 * 0.5), 1);
    EXPECT_NEAR(on[2], byte(0.5 * 0.5), 1);
    EXPECT_NEAR(beside[0], byte(0.5), 1);
    EXPECT_NEAR(beside[1], byte(0.25), 1);
    EXPECT_NEAR(beside[2], byte(0.25), 1);
}

// At any times of the instances, slices take the budget and nothing else grows.
TEST_F(SetFrameTest, CopiesOnASetCostNoMemory) {
    const voctree::VOctree tree =
        random_tree({.seed = 8, .node_levels = 4, .leaves = 20000, .hh_degree = 2, .frames = 40});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    GlbBuilder glb;
    add_mesh(glb, floor_mesh(), pbr_material({0.8f, 0.8f, 0.8f, 1}, 0, 1));
    const render::SetLight light = lamp({0, 8, 4}, {0, 0, 0}, 200);
    const auto bytes_with = [&](int copies) {
        const uint64_t before = device().buffer_bytes();
        OnSet stage(device(), glb, {&field},
                    {kWidth, kHeight, 1, 1, render::slice_bytes(field, render::max_entries(field))});
        stage.set.lighting.light(std::span(&light, 1), {});
        std::vector<render::Instance> instances;
        for (int i = 0; i < copies; ++i) {
            glm::mat4 transform(1);
            transform[3] = {2.2f * static_cast<float>(i % 8 - 4), 0.2f, -2.2f * static_cast<float>(i / 8), 1};
            instances.push_back({39.0f * static_cast<float>(i) / 31, transform});
        }
        render::FrameSettings settings = settings_of(instances);
        settings.lit = true;
        stage.frames.render(look_at({0, 3, 12}, {0, 0, 0}, kWidth, kHeight, 1), settings);
        return static_cast<double>(device().buffer_bytes() - before + field.whole_weights().bytes);
    };
    const double one = bytes_with(1);
    EXPECT_GT(one, static_cast<double>(field.whole_weights().bytes));
    EXPECT_LE(bytes_with(32), 1.01 * one);
}

TEST_F(SetFrameTest, ImagesLargerThanTheSetAreRefusedAndSmallerOnesAreDrawn) {
    const voctree::VOctree tree = cube(1);
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    GlbBuilder glb;
    add_mesh(glb, floor_mesh(), json::object());
    OnSet stage(device(), glb, {&field}, {kWidth, kHeight, 2});
    OnSet small(device(), glb, {&field}, {kWidth, kHeight, 1});
    EXPECT_THROW(small.frames.render(camera_before(), settings_of({{0}}, 2)), RuntimeFailure);
    stage.frames.render(camera_before(), settings_of({{0}}, 2));
    EXPECT_EQ(stage.frames.render(camera_before(), settings_of({{0}}, 1)).rgba,
              small.frames.render(camera_before(), settings_of({{0}}, 1)).rgba);
    EXPECT_NO_THROW(stage.frames.render(camera_before(), settings_of({}, 2))) << "a set alone";
}

}  // namespace
}  // namespace neuvv::test::set_frame_test
