// Inspection against the reference: the level at which rays meet a surface, and the steps of their walks.
#include "render/volume/inspect.h"
#include "gpu/host_copies.h"

#include <gtest/gtest.h>

#include <bit>
#include <glm/gtc/matrix_transform.hpp>

#include "reference/camera.h"
#include "reference/inspect.h"
#include "render/frame/frame_renderer.h"
#include "support/gpu_test.h"
#include "support/look_at.h"
#include "support/random_tree.h"

namespace neuvv::test::inspect_test {
namespace {

constexpr uint32_t kWidth = 61, kHeight = 43;
constexpr float kFrame = 1.5f;

using InspectTest = GpuTest;

// Dense enough that most rays that meet leaves pass alpha 0.5, some of them not in their first leaf.
voctree::VOctree dense_tree(uint64_t seed, uint32_t node_levels) {
    voctree::VOctree tree = random_tree({.seed = seed, .node_levels = node_levels, .leaves = 1500});
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
        for (uint32_t c = 0; c < tree.bases; ++c) tree.leaf(leaf)[c] *= 8;
    return tree;
}

stage::Camera camera_on(double away = 1) {
    return look_at(away * glm::dvec3(2.2, 1.9, 2.6), {0, 0.4, 0}, kWidth, kHeight, 1.1);
}

render::FrameSettings settings_of(std::vector<render::Instance> instances, render::Show show = render::Show::kLevel) {
    render::FrameSettings settings;
    settings.instances = std::move(instances);
    settings.width = kWidth;
    settings.height = kHeight;
    settings.mode = render::TraceMode::kPlay;
    settings.resolve.show = show;
    return settings;
}

struct Rays {
    std::vector<glm::vec4> walks;  // level, steps, 0, alpha
    std::vector<float> metres;
    std::vector<reference::Interval> ranges;  // per ray: its tile's range for the instance that was traced last
};

reference::Interval range_of(glm::uvec2 bits) {
    if (bits.x == kNoTile) return {1, 0};
    return {double{std::bit_cast<float>(bits.x)}, double{std::bit_cast<float>(~bits.y)}};
}

Rays inspect_on_device(const gpu::Device& device, render::FrameRenderer& renderer, const stage::Camera& camera,
                       const render::FrameSettings& settings) {
    renderer.render(camera, settings);
    Rays rays{renderer.radiance(), renderer.depth(), {}};
    const uint32_t across = (kWidth + kTile - 1) / kTile, down = (kHeight + kTile - 1) / kTile;
    std::vector<glm::uvec2> tiles(size_t{across} * down);
    gpu::download(device, renderer.target().ranges.ranges, tiles.data(), tiles.size() * sizeof(glm::uvec2));
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 0; x < kWidth; ++x) rays.ranges.push_back(range_of(tiles[y / kTile * across + x / kTile]));
    return rays;
}

// σ in fp16, as slice trees store it, so that rays end in the same leaves.
std::vector<reference::LeafSlice> slices_of(const voctree::VOctree& tree, bool half) {
    std::vector<reference::LeafSlice> slices = reference::slice_tree(tree, double{kFrame});
    for (reference::LeafSlice& slice : slices)
        if (half)
            slice.sigma = double{voctree::float_from_half(voctree::half_from_float(static_cast<float>(slice.sigma)))};
    return slices;
}

// The reference's walks of all rays of one instance, between the ranges of the device.
struct Truth {
    const voctree::VOctree& tree;
    std::vector<reference::LeafSlice> slices;
    reference::WalkNodes nodes;
    bool pruned;
    Truth(const voctree::VOctree& of, const render::Field& field, bool is_pruned)
        : tree(of),
          slices(slices_of(of, is_pruned)),
          nodes(walk_nodes(of, slices, field.box_size.x > of.box_size.x ? 1 : 0, field.top_levels, is_pruned)),
          pruned(is_pruned) {}

    reference::Inspected at(const stage::Camera& camera, const render::Instance& instance, uint32_t x, uint32_t y,
                            reference::Interval range) const {
        reference::Ray ray = reference::camera_ray(camera, x, y);
        const glm::dmat4 performer_from_world = glm::inverse(glm::dmat4(instance.world_from_performer));
        ray.origin = glm::dvec3(performer_from_world * glm::dvec4(ray.origin, 1));
        const glm::dvec3 direction = glm::dmat3(performer_from_world) * ray.direction;
        ray.direction = glm::normalize(direction);
        reference::Inspected result = reference::inspect(
            tree, slices, nodes, pruned, {ray, range, double{instance.opacity}, double{render::kStopTransmittance}});
        if (range.empty()) result.nodes = result.leaves = 0;
        result.distance_m /= glm::length(direction);
        return result;
    }
};

struct Agreement {
    uint32_t met = 0, missed = 0, other_levels = 0, other_steps = 0;
    double worst_m = 0, worst_alpha = 0;
};

Agreement compare(const Truth& truth, const stage::Camera& camera, const render::Instance& instance, const Rays& rays) {
    Agreement agreement;
    for (uint32_t i = 0; i < kWidth * kHeight; ++i) {
        const reference::Inspected one = truth.at(camera, instance, i % kWidth, i / kWidth, rays.ranges[i]);
        (one.level > 0 ? agreement.met : agreement.missed)++;
        const auto level = static_cast<uint32_t>(rays.walks[i].x), steps = static_cast<uint32_t>(rays.walks[i].y);
        agreement.other_levels += level != one.level;
        agreement.other_steps += steps != one.nodes + one.leaves;
        agreement.worst_alpha = std::max(agreement.worst_alpha, std::abs(one.alpha - double{rays.walks[i].a}));
        EXPECT_EQ(std::isinf(rays.metres[i]), level == 0);
        if (one.level > 0 && level == one.level)
            agreement.worst_m = std::max(agreement.worst_m, std::abs(one.distance_m - double{rays.metres[i]}));
    }
    return agreement;
}

// In single precision, rays that graze an edge may pass through another leaf or node there.
constexpr uint32_t kTies = kWidth * kHeight / 500;

TEST_F(InspectTest, LevelsAndStepsAreThoseOfTheReference) {
    for (const uint32_t node_levels : {1u, 2u, 3u})
        for (const uint64_t seed : {3u, 4u}) {
            const voctree::VOctree tree = dense_tree(seed, node_levels);
            const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
            const stage::Camera camera = camera_on();
            for (const uint64_t budget : {render::kSliceBudget, uint64_t{0}})
                for (const float opacity : {1.0f, 0.7f}) {
                    SCOPED_TRACE(::testing::Message() << node_levels << " levels, seed " << seed << ", budget "
                                                      << budget << ", " << opacity);
                    render::FrameRenderer renderer(device(), field, {kWidth, kHeight, 1, 1, budget});
                    render::Instance instance{kFrame};
                    instance.opacity = opacity;
                    const Rays rays = inspect_on_device(device(), renderer, camera, settings_of({instance}));
                    const Truth truth(tree, field, budget > 0);
                    const Agreement agreement = compare(truth, camera, instance, rays);
                    EXPECT_GT(agreement.met, 300u);
                    EXPECT_GT(agreement.missed, 300u);
                    EXPECT_LE(agreement.other_levels, kTies);
                    EXPECT_LE(agreement.other_steps, kTies);
                    EXPECT_LE(agreement.worst_m, 1e-3);
                    render::Instance other = instance;
                    other.opacity *= 0.9f;
                    const Agreement wrong = compare(truth, camera, other, rays);
                    EXPECT_GT(wrong.worst_alpha, 0.05) << "the comparison notices another opacity";
                    EXPECT_LE(agreement.worst_alpha, 1e-3);
                    Truth unpruned(tree, field, budget == 0);
                    EXPECT_GT(compare(unpruned, camera, instance, rays).other_steps, 100u)
                        << "the comparison notices other nodes";
                }
        }
}

// Two instances that overlap, that are one before the other, and that are far apart.
TEST_F(InspectTest, CostsOfInstancesAddAndTheNearestLevelShows) {
    const voctree::VOctree tree = dense_tree(5, 2);
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const stage::Camera camera = camera_on(1.6);
    const glm::mat4 turned = glm::rotate(glm::mat4(1), 0.6f, glm::vec3(0.1f, 1, 0.2f));
    const Truth truth(tree, field, true);
    for (const glm::vec3 shift : {glm::vec3(0.2f, 0.1f, 0), glm::vec3(-2.1f, -1.5f, -2.4f), glm::vec3(2.5f, 0, -2.5f)})
        for (const render::Blend blend : {render::Blend::kExact, render::Blend::kPaper}) {
            const render::Instance here{kFrame};
            const render::Instance there{kFrame,
                                         glm::scale(glm::translate(glm::mat4(1), shift) * turned, glm::vec3(1.2f))};
            render::FrameRenderer renderer(device(), field, {kWidth, kHeight});
            const auto inspected = [&](std::vector<render::Instance> instances) {
                render::FrameSettings settings = settings_of(std::move(instances));
                settings.blend = blend;
                return inspect_on_device(device(), renderer, camera, settings);
            };
            const Rays both = inspected({there, here}), first = inspected({here}), second = inspected({there});
            uint32_t others = 0, twice = 0, hidden = 0;
            for (uint32_t i = 0; i < kWidth * kHeight; ++i) {
                const uint32_t x = i % kWidth, y = i / kWidth;
                const reference::Inspected near = truth.at(camera, here, x, y, first.ranges[i]);
                const reference::Inspected far = truth.at(camera, there, x, y, second.ranges[i]);
                const bool nearer = near.level > 0 && (far.level == 0 || near.distance_m < far.distance_m);
                uint32_t steps = near.nodes + near.leaves + far.nodes + far.leaves;
                // An instance is not walked where its whole range is behind something solid. `there` is the farther
                // one.
                const double begins = 1.2 * second.ranges[i].enter;
                if (near.alpha > 1 - double{render::kStopTransmittance} && near.distance_m < begins && far.nodes > 0) {
                    steps = near.nodes + near.leaves;
                    ++hidden;
                }
                const bool same = static_cast<uint32_t>(both.walks[i].x) == (nearer ? near.level : far.level) &&
                                  static_cast<uint32_t>(both.walks[i].y) == steps;
                others += !same;
                twice += near.level > 0 && far.level > 0;
            }
            EXPECT_LE(others, 2 * kTies);
            EXPECT_TRUE(shift.x > 1 || twice > 100) << twice;
            EXPECT_TRUE(shift.x > 0 || hidden > 30) << hidden;
        }
}

void expect_colour(const uint8_t* pixel, bool any, double value) {
    const glm::dvec3 wanted = any ? reference::viridis(glm::clamp(value, 0.0, 1.0)) : glm::dvec3(0);
    for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(pixel[channel], 255 * wanted[channel], 0.75);
    EXPECT_EQ(pixel[3], 255);
}

TEST_F(InspectTest, ImagesShowLevelsAndCostsByTheMap) {
    const voctree::VOctree tree = dense_tree(6, 2);
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const stage::Camera camera = camera_on();
    uint32_t coarsest = 99, finest = 0;
    for (const voctree::LeafPosition& position : voctree::leaf_positions(tree)) {
        coarsest = std::min(coarsest, position.depth);
        finest = std::max(finest, position.depth);
    }
    ASSERT_LT(coarsest, finest);
    for (const uint32_t samples : {1u, 2u})
        for (const render::Show show : {render::Show::kLevel, render::Show::kCost}) {
            render::FrameRenderer renderer(device(), field, {kWidth, kHeight, samples});
            render::FrameSettings settings = settings_of({{kFrame}}, show);
            settings.samples = samples;
            settings.resolve.cost_max = 20;
            const media::Image image = renderer.render(camera, settings);
            const std::vector<glm::vec4> walks = renderer.radiance();
            const std::vector<float> metres = renderer.depth();
            for (uint32_t y = 0; y < kHeight; ++y)
                for (uint32_t x = 0; x < kWidth; ++x) {
                    double level = 0, nearest = INFINITY, steps = 0;
                    for (uint32_t i = 0; i < samples * samples; ++i) {
                        const size_t ray =
                            size_t{samples * y + i / samples} * samples * kWidth + samples * x + i % samples;
                        steps += double{walks[ray].y} / (samples * samples);
                        if (double{metres[ray]} < nearest) level = double{walks[ray].x};
                        nearest = std::min(nearest, double{metres[ray]});
                    }
                    if (show == render::Show::kLevel)
                        expect_colour(image.at(x, y), level > 0, (level - coarsest) / (finest - coarsest));
                    else
                        expect_colour(image.at(x, y), steps > 0, steps / 20);
                }
        }
}

// The map equals matplotlib's table at five of its 256 entries, and its brightness increases.
TEST_F(InspectTest, TheMapIsViridis) {
    const std::pair<int, glm::dvec3> table[] = {
        {0, {68, 1, 84}}, {64, {59, 82, 139}}, {128, {33, 145, 140}}, {191, {92, 200, 99}}, {255, {253, 231, 37}}};
    for (const auto& [at, colour] : table)
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(255 * reference::viridis(at / 255.0)[channel], colour[channel], 3) << at;
    double last = 0;
    for (int at = 0; at <= 255; ++at) {
        const glm::dvec3 colour = reference::viridis(at / 255.0);
        double light = 0;  // luminance, by the weights of sRGB's primaries
        for (int channel = 0; channel < 3; ++channel)
            light += glm::dvec3(0.2126, 0.7152, 0.0722)[channel] * std::pow(colour[channel], 2.2);
        EXPECT_GT(light, last) << at;
        last = light;
    }
}

// Where rays are fewer than pixels, each pixel shows the nearest ray.
TEST_F(InspectTest, FewerRaysThanPixelsShowTheNearest) {
    const voctree::VOctree tree = dense_tree(7, 2);
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    render::FrameRenderer renderer(device(), field, {kWidth, kHeight});
    render::FrameSettings settings = settings_of({{kFrame}}, render::Show::kCost);
    settings.scale = 0.5;
    settings.resolve.cost_max = 20;
    const media::Image image = renderer.render(camera_on(), settings);
    const std::vector<glm::vec4> walks = renderer.radiance();
    const auto across = static_cast<uint32_t>(std::ceil(0.5 * kWidth));
    const auto ray_of = [](uint32_t pixel, uint32_t pixels) {
        return static_cast<size_t>((pixel + 0.5) * std::ceil(0.5 * pixels) / pixels);
    };
    ASSERT_EQ(walks.size(), across * static_cast<size_t>(std::ceil(0.5 * kHeight)));
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 0; x < kWidth; ++x) {
            const double steps = double{walks[ray_of(y, kHeight) * across + ray_of(x, kWidth)].y};
            expect_colour(image.at(x, y), steps > 0, steps / 20);
        }
}

// An inspection does not change the next image of light.
TEST_F(InspectTest, LightComesBackAsItWas) {
    const voctree::VOctree tree = dense_tree(8, 2);
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    render::FrameRenderer renderer(device(), field, {kWidth, kHeight});
    const glm::mat4 beside = glm::translate(glm::mat4(1), glm::vec3(0.5f, 0.2f, 0.1f));
    const auto image = [&](render::Show show) {
        return renderer.render(camera_on(1.4), settings_of({{kFrame}, {0.5f, beside}}, show)).rgba;
    };
    const auto light = image(render::Show::kColour), level = image(render::Show::kLevel),
               cost = image(render::Show::kCost);
    EXPECT_NE(level, light);
    EXPECT_NE(level, cost);
    EXPECT_EQ(image(render::Show::kColour), light);
    EXPECT_EQ(image(render::Show::kLevel), level);
}

}  // namespace
}  // namespace neuvv::test::inspect_test
