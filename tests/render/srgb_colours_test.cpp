// Fields whose colours are sRGB (PlenOctrees): they are composited as such along a ray and decoded once, against the
// reference in double precision.
#include <gtest/gtest.h>

#include "media/colour.h"
#include "reference/trace.h"
#include "render/volume/reference_paths.h"
#include "render/volume/slices/paint.h"
#include "support/gpu_test.h"
#include "support/look_at.h"
#include "support/random_tree.h"
#include "support/traced.h"

namespace neuvv::test::srgb_colours_test {
namespace {

constexpr uint32_t kWidth = 61, kHeight = 43;

using SrgbColoursTest = GpuTest;

voctree::VOctree srgb_tree() {
    voctree::VOctree tree = random_tree({.seed = 3, .node_levels = 3, .leaves = 1500, .bases = 5, .hh_degree = 2});
    tree.has_srgb_colours = true;
    return tree;
}

stage::Camera camera_of(const voctree::VOctree& tree) {
    return look_at(world_of(tree, {1.7, 1.4, 2.1}), world_of(tree, glm::dvec3(0.5)), kWidth, kHeight, 1.1);
}

// What was summed along rays as sRGB, decoded.
Traced decoded(Traced traced) {
    for (glm::vec4& light : traced.radiance)
        if (light.a > 0) {
            const double a = double{light.a};
            light = glm::vec4(a * media::linear_from_srgb(glm::dvec3(light) / a), a);
        }
    return traced;
}

// The sum along rays of samples that are decoded one by one.
Traced sample_by_sample(const voctree::VOctree& tree, const stage::Camera& camera) {
    const std::vector<reference::LeafSlice> slices = reference::slice_tree(tree, 0);
    Traced traced;
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 0; x < kWidth; ++x) {
            std::vector<reference::Sample> samples =
                reference::ray_samples(tree, slices, reference::camera_ray(camera, x, y));
            for (reference::Sample& sample : samples) sample.colour = media::linear_from_srgb(sample.colour);
            const reference::RayResult ray = reference::composite(samples);
            traced.radiance.emplace_back(glm::vec3(ray.colour), static_cast<float>(ray.alpha));
            traced.depth.push_back(static_cast<float>(ray.depth_m));
        }
    return traced;
}

void expect_same(const Traced& traced, const Traced& truth, double steps) {
    const Difference found = difference(traced, truth);
    EXPECT_LE(found.steps, steps);
    EXPECT_LE(found.depth_m, 5 * kDepth_m);
    EXPECT_GT(found.alpha_mean, 0.1);
}

TEST_F(SrgbColoursTest, AreSummedAlongARayAndDecodedOnce) {
    const voctree::VOctree tree = srgb_tree();
    const stage::Camera camera = camera_of(tree);
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const Traced truth = decoded(trace_by_reference(tree, camera, 0, 0));
    render::FrameRenderer frames(device(), field, {kWidth, kHeight});
    expect_same(trace_on_device(frames, camera, 0, render::TraceMode::kTree, 0), truth, kHalfSteps);
    expect_same(trace_on_device(frames, camera, 0, render::TraceMode::kShaded, 0),
                decoded(shade_by_reference(tree, camera, 0)), kHalfSteps);
    render::FrameRenderer without_slices(device(), field, {kWidth, kHeight, 1, 1, 0});
    expect_same(trace_on_device(without_slices, camera, 0, render::TraceMode::kTree, 0), truth, kHalfSteps);
    render::ReferenceRenderer references(device(), field, kWidth, kHeight);
    for (const auto path :
         {render::ReferencePath::kSlots, render::ReferencePath::kDirect, render::ReferencePath::kPaper}) {
        references.render(camera, {.path = path, .frame = 0, .stop = 0});
        expect_same({references.radiance(), references.depth()}, truth, kSteps);
    }
    EXPECT_GT(difference(sample_by_sample(tree, camera), truth).steps, 4) << "the scene shows which of both is done";
}

// Copies that stand in each other, each half as dense, are one medium of linear light: each sample is decoded.
TEST_F(SrgbColoursTest, AreDecodedBeforeTheyAreMerged) {
    const voctree::VOctree tree = srgb_tree();
    const stage::Camera camera = camera_of(tree);
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    render::FrameRenderer renderer(device(), field, {kWidth, kHeight});
    render::FrameSettings settings;
    settings.instances.resize(2);
    for (render::Instance& instance : settings.instances) instance.density = 0.5f;
    settings.width = kWidth;
    settings.height = kHeight;
    settings.stop = 0;
    renderer.render(camera, settings);
    ASSERT_EQ(passes(renderer, "merge"), 1u);
    expect_same({renderer.radiance(), renderer.depth()}, sample_by_sample(tree, camera), kHalfSteps);
}

// A colour that paint gives is linear light, whatever the field's are.
TEST_F(SrgbColoursTest, TakePaintOfLinearLight) {
    const voctree::VOctree tree = srgb_tree();
    const stage::Camera camera = camera_of(tree);
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const glm::vec3 target(0.125f, 0.5f, 0.25f);
    voctree::EditLayer layer;
    layer.field = voctree::painted_field(tree);
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
        voctree::LeafEdit edit;
        edit.leaf = leaf;
        edit.colour = target;
        edit.alpha = 1;
        layer.edits.push_back(edit);
    }
    const render::PaintUse use{&layer, stage::PaintBlend::kNormal, 1};
    render::FrameRenderer renderer(device(), field, {kWidth, kHeight});
    render::FrameSettings settings;
    settings.instances[0].paint =
        renderer.paints().add(std::make_shared<const render::Paint>(device(), tree.leaf_count, std::span(&use, 1)));
    settings.width = kWidth;
    settings.height = kHeight;
    renderer.render(camera, settings);
    size_t seen = 0;
    for (const glm::vec4 light : renderer.radiance()) {
        if (light.a < 0.1f) continue;
        ++seen;
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(light[c] / light.a, target[c], 2e-3);
    }
    EXPECT_GT(seen, 100u);
}

}  // namespace
}  // namespace neuvv::test::srgb_colours_test
