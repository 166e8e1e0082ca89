// Several instances of one performer, each with its transform and time, and several views, against the reference.
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "base/error.h"
#include "reference/trace.h"
#include "support/gpu_test.h"
#include "support/look_at.h"
#include "support/random_tree.h"
#include "support/traced.h"

namespace neuvv::test::instances_test {
namespace {

constexpr uint32_t kWidth = 61, kHeight = 43;

using InstancesTest = GpuTest;

// The layer of one instance: its ray in the performer's space (errata 13), its depth in metres of the world.
reference::RayResult trace_instance(const voctree::VOctree& tree, const std::vector<reference::LeafSlice>& slices,
                                    const render::Instance& instance, reference::Ray ray) {
    const glm::dmat4 performer_from_world = glm::inverse(glm::dmat4(instance.world_from_performer));
    ray.origin = glm::dvec3(performer_from_world * glm::dvec4(ray.origin, 1));
    const glm::dvec3 direction = glm::dmat3(performer_from_world) * ray.direction;
    ray.direction = glm::normalize(direction);
    reference::RayResult result = reference::trace(tree, slices, ray);
    result.depth_m /= glm::length(direction);
    return result;
}

// Algorithm 1 (errata 11), with layers in the order of the distances of the instances' centres from the eye.
Traced compose_by_reference(const voctree::VOctree& tree, std::vector<render::Instance> instances,
                            const stage::Camera& camera) {
    const auto [low, high] = [&] {
        glm::dvec3 first(1e30), last(-1e30);
        for (const voctree::LeafPosition& position : voctree::leaf_positions(tree)) {
            const double edge = std::exp2(-static_cast<double>(position.depth));
            const glm::dvec3 corner = edge * glm::dvec3(position.x, position.y, position.z);
            first = glm::min(first, corner);
            last = glm::max(last, corner + edge);
        }
        return std::pair(world_of(tree, first), world_of(tree, last));
    }();
    const glm::dvec4 centre(0.5 * (low + high), 1);
    const glm::dvec3 eye(camera.world_from_camera[3]);
    std::sort(instances.begin(), instances.end(), [&](const render::Instance& a, const render::Instance& b) {
        const auto away = [&](const render::Instance& one) {
            return glm::distance(eye, glm::dvec3(glm::dmat4(one.world_from_performer) * centre));
        };
        return away(a) < away(b);
    });
    std::vector<std::vector<reference::LeafSlice>> slices;
    for (const render::Instance& instance : instances) slices.push_back(reference::slice_tree(tree, instance.frame));
    Traced traced;
    for (uint32_t y = 0; y < camera.height; ++y)
        for (uint32_t x = 0; x < camera.width; ++x) {
            glm::dvec4 sum(0);
            double depth = INFINITY;
            for (size_t i = 0; i < instances.size(); ++i) {
                const reference::RayResult layer =
                    trace_instance(tree, slices[i], instances[i], reference::camera_ray(camera, x, y));
                const glm::dvec4 light(layer.colour, layer.alpha);
                sum = layer.depth_m <= depth ? light + (1 - light.a) * sum : sum + (1 - sum.a) * light;
                depth = std::min(depth, layer.depth_m);
            }
            traced.radiance.emplace_back(sum);
            traced.depth.push_back(static_cast<float>(depth));
        }
    return traced;
}

// A row of performers: rotated, stretched, mirrored, sheared, one of them far away, two at the same time of the clip.
std::vector<render::Instance> a_stage() {
    glm::mat4 shear(1);
    shear[1][0] = 0.4f;
    shear[2][1] = -0.3f;
    return {{1.3f, glm::mat4(1)},
            {0.0f, placed({4, 0.3f, -1}, 0.7f, glm::vec3(1.4f, 0.6f, 1))},
            {2.0f, placed({-4, 0, 1}, -2.1f, glm::vec3(-0.8f, 0.9f, 1.1f))},
            {3.6f, placed({1, -0.5f, -6}, 0, glm::vec3(1.5f)) * shear},
            {1.3f, placed({-9, 4, -14}, 1, glm::vec3(3))}};
}

render::FrameSettings settings_of(std::vector<render::Instance> instances, render::TraceMode mode) {
    render::FrameSettings settings;
    settings.instances = std::move(instances);
    settings.width = kWidth;
    settings.height = kHeight;
    settings.mode = mode;
    settings.blend = render::Blend::kPaper;
    settings.stop = 0;
    return settings;
}

stage::Camera stage_camera(double shift_m = 0) {
    return look_at({1.2 + shift_m, 1.5, 9}, {shift_m, 0.4, 0}, kWidth, kHeight, 1.2);
}

TEST_F(InstancesTest, StandAndMoveAsTheirTransformsAndTimesSayWhateverTheBudget) {
    const voctree::VOctree tree =
        random_tree({.seed = 3, .node_levels = 3, .leaves = 1500, .bases = 5, .hh_degree = 2});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const Traced truth = compose_by_reference(tree, a_stage(), stage_camera());
    const uint64_t one = render::slice_bytes(field, render::max_entries(field));
    for (const auto& [budget, slices] : {std::pair(render::kSliceBudget, size_t{4}), std::pair(2 * one, size_t{2}),
                                         std::pair(uint64_t{0}, size_t{0})}) {
        SCOPED_TRACE("budget " + std::to_string(budget));
        render::FrameRenderer renderer(device(), field, {kWidth, kHeight, 1, 1, budget});
        renderer.render(stage_camera(), settings_of(a_stage(), render::TraceMode::kTree));
        EXPECT_EQ(passes(renderer, "slice nodes"), slices) << "copies at the same time share a slice";
        EXPECT_EQ(passes(renderer, "trace") + passes(renderer, "direct"), a_stage().size());
        const Difference found = difference({renderer.radiance(), renderer.depth()}, truth);
        EXPECT_LE(found.steps, kHalfSteps);
        EXPECT_LE(found.depth_m, 5 * kDepth_m) << "up to 20 m away";
        EXPECT_TRUE(found.depth_class);
        EXPECT_GT(found.alpha_mean, 0.1);
        renderer.render(stage_camera(), settings_of(a_stage(), render::TraceMode::kTree));
        EXPECT_EQ(passes(renderer, "slice nodes"), 0u) << "slices stay";
    }
}

TEST_F(InstancesTest, WhatStandsBehindSomethingSolidChangesLessThanAStep) {
    voctree::VOctree tree = random_tree({.seed = 5, .node_levels = 3, .leaves = 3000, .hh_degree = 1});
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
        for (uint32_t c = 0; c < tree.bases; ++c) tree.leaf(leaf)[c] *= 30;
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
    const std::vector<render::Instance> row = {{1, glm::mat4(1)},
                                               {1, placed({-0.4f, -0.3f, -4}, 0, glm::vec3(1.2f))},
                                               {1, placed({-0.8f, -0.6f, -8}, 0, glm::vec3(1.5f))}};
    render::FrameRenderer renderer(device(), field, {kWidth, kHeight});
    render::FrameSettings settings = settings_of(row, render::TraceMode::kTree);
    settings.stop = render::kStopTransmittance;
    renderer.render(stage_camera(), settings);
    EXPECT_LE(
        difference({renderer.radiance(), renderer.depth()}, compose_by_reference(tree, row, stage_camera())).steps, 1);
}

TEST_F(InstancesTest, ViewsOfOneFrameAreTheirImagesAlone) {
    const voctree::VOctree tree = random_tree({.seed = 4, .node_levels = 3, .leaves = 2000, .hh_degree = 1});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const stage::Camera eyes[] = {stage_camera(-0.03), stage_camera(0.03)};
    render::FrameRenderer both(device(), field, {kWidth, kHeight, 2, 2}), alone(device(), field, {kWidth, kHeight, 2});
    for (const uint32_t samples : {1u, 2u}) {
        render::FrameSettings settings = settings_of(a_stage(), render::TraceMode::kTree);
        settings.samples = samples;
        settings.resolve.background = {0.2f, 0.3f, 0.1f, 1};
        const std::vector<media::Image> images = both.render_views(eyes, settings);
        EXPECT_EQ(passes(both, "trace"), a_stage().size()) << "both eyes in one dispatch";
        ASSERT_EQ(images.size(), 2u);
        EXPECT_NE(images[0].rgba, images[1].rgba);
        for (uint32_t view = 0; view < 2; ++view) {
            EXPECT_EQ(images[view].rgba, alone.render(eyes[view], settings).rgba) << "view " << view;
            EXPECT_EQ(both.radiance(view), alone.radiance());
        }
    }
}

TEST_F(InstancesTest, EveryViewHasItsShadedLeaves) {
    const voctree::VOctree tree = random_tree({.seed = 4, .node_levels = 4, .leaves = 6000, .hh_degree = 2});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const stage::Camera eyes[] = {stage_camera(-4), stage_camera(4)};
    render::FrameRenderer both(device(), field, {kWidth, kHeight, 1, 2}), alone(device(), field, {kWidth, kHeight});
    const render::FrameSettings settings = settings_of(a_stage(), render::TraceMode::kShaded);
    const std::vector<media::Image> images = both.render_views(eyes, settings);
    EXPECT_EQ(passes(both, "shade"), 2 * a_stage().size());
    for (uint32_t view = 0; view < 2; ++view) {
        EXPECT_EQ(images[view].rgba, alone.render(eyes[view], settings).rgba) << "view " << view;
        EXPECT_NE(images[view].rgba, alone.render(eyes[view], settings_of(a_stage(), render::TraceMode::kTree)).rgba)
            << "nothing is shaded";
    }
}

TEST_F(InstancesTest, CopiesCostNoMemoryBeyondTheBudget) {
    const voctree::VOctree tree =
        random_tree({.seed = 8, .node_levels = 4, .leaves = 20000, .hh_degree = 2, .frames = 40});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    std::vector<render::Instance> copies;
    for (int i = 0; i < 16; ++i)
        copies.push_back({2.4f * static_cast<float>(i),
                          placed({2.5f * static_cast<float>(i % 4), 0, -2.5f * static_cast<float>(i / 4)},
                                 static_cast<float>(i), glm::vec3(1))});
    const uint64_t one = render::slice_bytes(field, render::max_entries(field));
    for (const uint64_t budget : {uint64_t{0}, one, 3 * one}) {
        const auto bytes_with = [&](const std::vector<render::Instance>& instances) {
            const uint64_t before = device().buffer_bytes();
            render::FrameRenderer renderer(device(), field, {kWidth, kHeight, 1, 1, budget});
            renderer.render(stage_camera(), settings_of(instances, render::TraceMode::kPlay));
            return device().buffer_bytes() - before + field.whole_weights().bytes;
        };
        const uint64_t alone = bytes_with({copies[0]}), all = bytes_with(copies);
        EXPECT_GT(alone, field.whole_weights().bytes + budget);
        EXPECT_LE(all, alone + budget + 16 * 1024) << "budget " << budget;
        if (budget > 0) continue;
        EXPECT_LE(static_cast<double>(all), 1.01 * static_cast<double>(alone));
    }
}

// Prefetched in a part per image, whatever is drawn meanwhile, a slice is the same as one that is built at once.
TEST_F(InstancesTest, SlicesBuiltAheadAreThoseBuiltWhenNeeded) {
    const voctree::VOctree tree =
        random_tree({.seed = 3, .node_levels = 3, .leaves = 1500, .bases = 5, .hh_degree = 2});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const auto draw = [&](render::FrameRenderer& renderer, float frame, const std::vector<float>& next) {
        render::FrameSettings settings = settings_of({{frame}}, render::TraceMode::kTree);
        for (const float later : next) settings.next_instances.push_back({later});
        settings.prefetch_parts = 1;
        return renderer.render(stage_camera(), settings).rgba;
    };
    const auto slice_passes = [](const render::FrameRenderer& renderer) {
        return passes(renderer, "slice density") + passes(renderer, "slice nodes") + passes(renderer, "slice entries");
    };
    for (const bool disturbed : {false, true}) {
        render::FrameRenderer renderer(device(), field, {kWidth, kHeight}), fresh(device(), field, {kWidth, kHeight});
        draw(renderer, 0, {});
        for (uint32_t part = 0; part < 4; ++part) {
            draw(renderer, 0, {1.5f, 3});
            EXPECT_EQ(slice_passes(renderer), 1u) << "part " << part;
        }
        if (disturbed) {
            EXPECT_EQ(draw(renderer, 2, {}), draw(fresh, 2, {}));
        }
        const uint32_t left = disturbed ? render::kSliceParts : render::kSliceParts - 4;
        for (uint32_t part = 0; part < left; ++part) draw(renderer, 0, {1.5f, 3});
        EXPECT_EQ(draw(renderer, 1.5f, {}), draw(fresh, 1.5f, {}));
        EXPECT_EQ(slice_passes(renderer), 0u) << "it was ready";
        draw(renderer, 0, {3});
        EXPECT_EQ(draw(renderer, 3, {4}), draw(fresh, 3, {})) << "needed before it was ready";
        EXPECT_GE(slice_passes(renderer), render::kSliceParts - 1) << "what was missing, and a part of the next";
        EXPECT_EQ(draw(renderer, 0, {}), draw(fresh, 0, {}));
    }
}

TEST_F(InstancesTest, WhatCannotBeDrawnIsRefused) {
    const voctree::VOctree tree = random_tree({.seed = 6, .leaves = 20});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
    render::FrameRenderer renderer(device(), field, {kWidth, kHeight});
    const stage::Camera camera = stage_camera();
    const auto draw = [&](const std::vector<render::Instance>& instances) {
        renderer.render(camera, settings_of(instances, render::TraceMode::kPlay));
    };
    EXPECT_NO_THROW(draw({}));
    EXPECT_NO_THROW(draw(std::vector<render::Instance>(1)));
    EXPECT_THROW(draw({{0, glm::scale(glm::mat4(1), {1, 0, 1})}}), RuntimeFailure);
    EXPECT_THROW(draw({{0, glm::mat4(NAN)}}), RuntimeFailure);
    EXPECT_THROW(draw(std::vector<render::Instance>(render::kMaxInstances + 1)), RuntimeFailure);
    stage::Camera other = camera;
    ++other.width;
    EXPECT_THROW(renderer.render(other, settings_of(std::vector<render::Instance>(1), render::TraceMode::kPlay)),
                 RuntimeFailure);
    const stage::Camera two[] = {camera, camera};
    EXPECT_THROW(renderer.render_views(two, settings_of(std::vector<render::Instance>(1), render::TraceMode::kPlay)),
                 RuntimeFailure);
}

}  // namespace
}  // namespace neuvv::test::instances_test
