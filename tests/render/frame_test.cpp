// Whole frames, by slice and by the direct path, against the reference: every pixel's light, alpha and depth.
#include "gpu/host_copies.h"
#include "render/frame/frame_renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "base/error.h"
#include "render/volume/reference_paths.h"
#include "support/gpu_test.h"
#include "support/look_at.h"
#include "support/random_tree.h"
#include "support/traced.h"
#include "voctree/files/nvv.h"

namespace neuvv::test::frame_test {
namespace {

constexpr uint32_t kWidth = 45, kHeight = 35;  // no multiples of a tile

// Looks along world −Z with directions whose x and y are exactly 0 in the centre column and row.
stage::Camera axis_camera(glm::dvec3 eye, double focal_pixels) {
    stage::Camera camera = look_at(eye, eye - glm::dvec3(0, 0, 1), kWidth, kHeight);
    camera.fx = camera.fy = focal_pixels;
    return camera;
}

struct View {
    std::string name;
    stage::Camera camera;
    bool sees = true;  // whether it hits the volume
};

std::vector<View> views(const voctree::VOctree& tree) {
    const double side = std::exp2(2.0 * tree.node_levels);  // finest cells
    const glm::dvec3 centre = world_of(tree, glm::dvec3(0.5));
    const auto looking = [](glm::dvec3 eye, glm::dvec3 at, double focal) {
        return look_at(eye, at, kWidth, kHeight, focal);
    };
    std::vector<View> all;
    all.push_back({"outside", looking(world_of(tree, {1.7, 1.4, 2.1}), centre, 1.1)});
    all.push_back({"outside, the other side", looking(world_of(tree, {-0.9, -0.3, -1.3}), centre, 1.1)});
    all.push_back({"inside", looking(world_of(tree, {0.43, 0.57, 0.61}), world_of(tree, {0.1, 0.2, 0.05}), 0.5)});
    all.push_back({"far away", looking(centre + glm::dvec3(11, 7, 23), centre, 14)});
    all.push_back({"axis-parallel", axis_camera(world_of(tree, {0.371, 0.523, 1.9}), 64)});
    all.push_back({"nearly axis-parallel", axis_camera(world_of(tree, {0.371, 0.523, 1.9}), 61.7)});
    all.push_back({"in a plane between cells", axis_camera(world_of(tree, {0.5, 0.523, 1.9}), 64)});
    // Rays that cross a face between cells at slopes of at most 1/100, and enter a thousandth of a cell above it.
    all.push_back({"grazing faces", looking(world_of(tree, {1.5, 0.5 + 1e-3 / side, 0.47}),
                                            world_of(tree, {0.5, 0.5 - 1e-3 / side, 0.47}), 50)});
    all.push_back({"beside", looking(world_of(tree, {1.2, 0.5, 0.5}), world_of(tree, {1.4, 0.5, 3}), 2), false});
    all.push_back({"behind", looking(world_of(tree, {0.5, 0.5, 1.2}), world_of(tree, {0.5, 0.6, 3}), 2), false});
    return all;
}

size_t wide_leaves(const voctree::VOctree& tree) {
    size_t count = 0;
    for (const voctree::LeafPosition& position : voctree::leaf_positions(tree)) count += position.depth % 2;
    return count;
}

Traced trace_by_path(render::ReferenceRenderer& renderer, const stage::Camera& camera, float frame,
                     render::ReferencePath path, float stop) {
    renderer.render(camera, {.path = path, .frame = frame, .stop = stop});
    return {renderer.radiance(), renderer.depth()};
}

// The renderers of a field, with room for the views of this test.
struct Renderers {
    Renderers(const gpu::Device& device, const render::Field& field)
        : frames(device, field, {kWidth, kHeight}), references(device, field, kWidth, kHeight) {}
    render::FrameRenderer frames;
    render::ReferenceRenderer references;
};

void expect_agreement(const voctree::VOctree& tree, const View& view, Renderers& renderers, float frame) {
    using render::ReferencePath, render::TraceMode;
    const Traced truth = trace_by_reference(tree, view.camera, frame, 0);
    const Traced trace = trace_by_path(renderers.references, view.camera, frame, ReferencePath::kSlots, 0);
    const Traced direct = trace_by_path(renderers.references, view.camera, frame, ReferencePath::kDirect, 0);
    const Traced paper = trace_by_path(renderers.references, view.camera, frame, ReferencePath::kPaper, 0);
    const Traced in_tree = trace_on_device(renderers.frames, view.camera, frame, TraceMode::kTree, 0);
    const Traced shaded = trace_on_device(renderers.frames, view.camera, frame, TraceMode::kShaded, 0);
    const Traced shaded_truth = shade_by_reference(tree, view.camera, frame);
    for (const auto& [name, a, b, steps] :
         {std::tuple("trace", &trace, &truth, kSteps), std::tuple("direct", &direct, &truth, kSteps),
          std::tuple("paper", &paper, &truth, kSteps), std::tuple("trace against direct", &trace, &direct, kSteps),
          std::tuple("slice tree", &in_tree, &truth, kHalfSteps),
          std::tuple("shaded", &shaded, &shaded_truth, kHalfSteps)}) {
        SCOPED_TRACE(view.name + ", " + name);
        const Difference found = difference(*a, *b);
        EXPECT_LE(found.steps, steps);
        EXPECT_LE(found.depth_m, kDepth_m);
        EXPECT_TRUE(found.depth_class);
        EXPECT_EQ(found.alpha_mean > 0.02, view.sees) << found.alpha_mean;
    }
}

using FrameTest = GpuTest;

// The position of the ray of cell (column, row) of a pixel's samples × samples cells, in pixels from the pixel's
// corner. The rays of a column of cells are at different positions across, and those of a row at different positions
// down, so that no two rays of the pixel share either coordinate.
glm::dvec2 rook(uint32_t column, uint32_t row, double samples) {
    return {(column + (row + 0.5) / samples) / samples, (row + (samples - column - 0.5) / samples) / samples};
}

// No two rays of a pixel share a coordinate, and the pixel is their mean.
TEST_F(FrameTest, SeveralRaysAPixel) {
    constexpr uint32_t kSamples = 3;
    const voctree::VOctree tree = random_tree({.seed = 5, .leaves = 300, .bases = 5, .hh_degree = 2});
    stage::Camera camera =
        look_at(world_of(tree, {1.7, 1.4, 2.1}), world_of(tree, glm::dvec3(0.5)), kWidth, kHeight, 1.1);
    camera.cx += 3.25;
    camera.cy -= 2.5;
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
    render::FrameRenderer renderer(device(), field, {kWidth, kHeight, kSamples});
    render::FrameSettings settings;
    settings.instances[0].frame = 1.5f;
    settings.width = kWidth;
    settings.height = kHeight;
    settings.samples = kSamples;
    settings.stop = 0;
    const media::Image image = renderer.render(camera, settings);
    const std::vector<glm::vec4> rays = renderer.radiance();
    const std::vector<reference::LeafSlice> slices = reference::slice_tree(tree, 1.5);
    double alpha_mean = 0;
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 0; x < kWidth; ++x) {
            glm::dvec4 mean(0);
            for (uint32_t i = 0; i < kSamples * kSamples; ++i) {
                const uint32_t column = kSamples * x + i % kSamples, row = kSamples * y + i / kSamples;
                const glm::dvec2 at = glm::dvec2(x, y) + rook(i % kSamples, i / kSamples, kSamples) - 0.5;
                const reference::RayResult truth =
                    reference::trace(tree, slices, reference::camera_ray(camera, at.x, at.y));
                mean += glm::dvec4(truth.colour, truth.alpha) / double{kSamples * kSamples};
                ASSERT_NEAR(rays[size_t{row} * kSamples * kWidth + column].a, truth.alpha, kSteps / 255);
            }
            alpha_mean += mean.a / (kWidth * kHeight);
            ASSERT_NEAR(image.at(x, y)[3], 255 * mean.a, 0.6);
            if (mean.a < 0.1) continue;  // straight colour is inexact where a pixel is nearly transparent
            for (int channel = 0; channel < 3; ++channel)
                ASSERT_NEAR(image.at(x, y)[channel], 255 * reference::display_value(mean[channel] / mean.a), 0.6);
        }
    EXPECT_GT(alpha_mean, 0.02);
}

TEST_F(FrameTest, TraceAndDirectMatchTheReferenceInEveryPixel) {
    const RandomTreeOptions kTrees[] = {
        {.seed = 1, .node_levels = 1, .leaves = 15, .bases = 1, .hh_degree = 0},
        {.seed = 2, .node_levels = 2, .leaves = 900, .bases = 5, .hh_degree = 1},
        {.seed = 3, .node_levels = 3, .leaves = 3000, .bases = 4, .hh_degree = 2},
        {.seed = 4, .node_levels = 4, .leaves = 3000, .bases = 7, .hh_degree = 3},
        {.seed = 5, .node_levels = 5, .leaves = 3000, .bases = 3, .hh_degree = 1},
        {.seed = 6, .node_levels = 6, .leaves = 9000, .bases = 3, .hh_degree = 1},
    };
    for (const RandomTreeOptions& options : kTrees) {
        SCOPED_TRACE("node levels " + std::to_string(options.node_levels));
        const voctree::VOctree tree = random_tree(options);
        ASSERT_GT(wide_leaves(tree), 0u);
        ASSERT_LT(wide_leaves(tree), tree.leaf_count);
        const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
        Renderers renderers(device(), field);
        for (const View& view : views(tree)) expect_agreement(tree, view, renderers, 1.3f);
    }
}

// Where most leaves are at odd depths, the walk tree has another root (render/volume/slices/walk_tree.h), also where
// levels are unused.
TEST_F(FrameTest, ATreeOfOddDepthsMatchesTheReference) {
    for (const uint32_t node_levels : {2u, 3u, 5u}) {
        voctree::VOctree tree = random_tree({.seed = 7, .node_levels = node_levels, .leaves = 300 * (node_levels - 1)});
        std::vector<voctree::LeafPosition> odd;
        std::vector<const float*> weights;
        const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
        for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
            if (positions[leaf].depth % 2 == 0) continue;
            odd.push_back(positions[leaf]);
            weights.push_back(tree.leaf(leaf));
        }
        voctree::replace_leaves(tree, odd, weights);
        ASSERT_GT(tree.leaf_count, 4u);
        const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
        EXPECT_EQ(field.box_size, 2.0f * tree.box_size);
        Renderers renderers(device(), field);
        expect_agreement(tree, views(tree)[0], renderers, 1.3f);
    }
}

TEST_F(FrameTest, ACubeAndAThinBoxAreMetricToo) {
    for (const glm::vec3 size : {glm::vec3(1), glm::vec3(0.2f, 3.0f, 1.1f)}) {
        voctree::VOctree tree = random_tree({.seed = 8, .node_levels = 2, .leaves = 700});
        tree.box_size = size;
        for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
            for (uint32_t c = 0; c < tree.bases; ++c) tree.leaf(leaf)[c] *= 3;
        const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
        Renderers renderers(device(), field);
        expect_agreement(tree, views(tree)[0], renderers, 3);
    }
}

TEST_F(FrameTest, EarlyTerminationChangesLessThanAStep) {
    voctree::VOctree tree = random_tree({.seed = 5, .node_levels = 3, .leaves = 3000, .hh_degree = 1});
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
        for (uint32_t c = 0; c < tree.bases; ++c) tree.leaf(leaf)[c] *= 12;
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
    render::ReferenceRenderer renderer(device(), field, kWidth, kHeight);
    const stage::Camera camera = views(tree)[0].camera;
    const Traced whole = trace_by_reference(tree, camera, 2, 0);
    for (const render::ReferencePath path :
         {render::ReferencePath::kSlots, render::ReferencePath::kDirect, render::ReferencePath::kPaper}) {
        const Traced stopped = trace_by_path(renderer, camera, 2, path, render::kStopTransmittance);
        EXPECT_LE(difference(stopped, whole).steps, 1);
        double lost = 0;
        for (size_t i = 0; i < whole.radiance.size(); ++i)
            lost = std::max(lost, static_cast<double>(whole.radiance[i].a - stopped.radiance[i].a));
        EXPECT_GT(lost, 0.05 * render::kStopTransmittance) << "no ray was ended early";
        EXPECT_LE(lost, render::kStopTransmittance);
        EXPECT_LE(difference(trace_by_path(renderer, camera, 2, path, 0), whole).steps, kSteps);
    }
}

// The worst case: what early termination leaves out is white, and what is before it is black, where sRGB is steepest.
TEST_F(FrameTest, EarlyTerminationBehindBlackChangesLessThanAStep) {
    voctree::VOctree tree;
    tree.bases = 1;
    tree.hh_degree = 0;
    tree.sigma_basis = tree.gamma_basis = {1};
    voctree::build_topology(tree, {{0, 0, 1, 1}, {0, 0, 0, 1}});
    const float front[] = {-std::log(0.99f * render::kStopTransmittance) / 0.5f, 0, -60, -60, -60};
    const float back[] = {1e4f, 0, 60, 60, 60};
    std::copy(std::begin(front), std::end(front), tree.leaf(0));
    std::copy(std::begin(back), std::end(back), tree.leaf(1));
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
    render::ReferenceRenderer renderer(device(), field, kWidth, kHeight);
    const stage::Camera camera = axis_camera({0.25, 0.25, 3}, 512);
    const Traced whole = trace_by_reference(tree, camera, 0, 0);
    const Traced stopped =
        trace_by_path(renderer, camera, 0, render::ReferencePath::kSlots, render::kStopTransmittance);
    EXPECT_GT(difference(stopped, whole).steps, 0.1) << "nothing was left out";
    EXPECT_LE(difference(stopped, whole).steps, 1);
}

// More tiles than a dimension of a dispatch may have on many devices.
TEST_F(FrameTest, AnImageOfVeryManyTilesIsWhole) {
    const voctree::VOctree tree = random_tree({.seed = 6, .node_levels = 1, .leaves = 20, .bases = 1, .hh_degree = 0});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
    const stage::Camera camera =
        look_at(world_of(tree, {1.7, 1.4, 2.1}), world_of(tree, glm::dvec3(0.5)), 2402, 1763, 0.7);
    render::ReferenceRenderer renderer(device(), field, camera.width, camera.height);
    const Traced traced = trace_by_path(renderer, camera, 0, render::ReferencePath::kSlots, 0);
    const std::vector<reference::LeafSlice> slices = reference::slice_tree(tree, 0);
    size_t hits = 0;
    for (size_t i = 0; i < traced.radiance.size(); i += 997) {
        const auto x = static_cast<double>(i % camera.width), y = static_cast<double>(i / camera.width);
        const reference::RayResult truth = reference::trace(tree, slices, reference::camera_ray(camera, x, y));
        hits += truth.alpha > 0;
        ASSERT_NEAR(traced.radiance[i].a, truth.alpha, kSteps / 255) << x << ' ' << y;
    }
    EXPECT_GT(hits, 100u);
}

TEST_F(FrameTest, LeavesAreShadedOnceWhereTheyAreSmallFromTheEye) {
    const voctree::VOctree tree = random_tree({.seed = 6, .node_levels = 3, .leaves = 3000});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
    EXPECT_EQ(render::play_shading(field, world_of(tree, {30, 1, 1}), 1e6), render::Shading::kPerLeaf);
    EXPECT_EQ(render::play_shading(field, world_of(tree, {1.1, 0.5, 0.5}), 1e6), render::Shading::kPerRay);
    EXPECT_EQ(render::play_shading(field, world_of(tree, {0.5, 0.5, 0.5}), 1e6), render::Shading::kPerRay);
    EXPECT_EQ(render::play_shading(field, world_of(tree, {30, 1, 1}), field.leaf_count / 10.0),
              render::Shading::kPerRay)
        << "few rays are less work than many leaves";
}

// The mean difference between shaded images and images shaded per ray must be at most 1/255, here over the covered
// pixels and at the smallest distance at which leaves are shaded.
TEST_F(FrameTest, ShadedImagesAreThoseByRay) {
    for (uint32_t degree = 1; degree <= kMaxHhDegree; ++degree) {
        const voctree::VOctree tree =
            random_tree({.seed = 60 + degree, .node_levels = 3, .leaves = 3000, .hh_degree = degree});
        const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
        double distance = 0.5;
        const auto eye = [&] { return world_of(tree, glm::dvec3(0.5) + distance * glm::dvec3(0.6, 0.3, 0.74)); };
        while (render::play_shading(field, eye(), 1e6) != render::Shading::kPerLeaf) distance *= 1.02;
        const stage::Camera camera = look_at(eye(), world_of(tree, glm::dvec3(0.5)), kWidth, kHeight, 4);
        render::FrameRenderer renderer(device(), field, {kWidth, kHeight});
        const Traced by_ray =
            trace_on_device(renderer, camera, 2, render::TraceMode::kTree, render::kStopTransmittance);
        const Traced shaded =
            trace_on_device(renderer, camera, 2, render::TraceMode::kShaded, render::kStopTransmittance);
        double sum = 0, covered = 0;
        for (size_t i = 0; i < by_ray.radiance.size(); ++i) {
            if (by_ray.radiance[i].a <= 1.0f / 255) continue;
            ++covered;
            for (int c = 0; c < 3; ++c)
                sum += std::abs(reference::display_value(shaded.radiance[i][c]) -
                                reference::display_value(by_ray.radiance[i][c]));
        }
        EXPECT_GT(covered, 100);
        EXPECT_GT(sum, 0) << "nothing is shaded";
        EXPECT_LE(sum / (3 * covered), 1.0 / 255) << "degree " << degree << ", distance " << distance;
    }
}

// A slice tree and the background are kept for the next image only where they are the same.
TEST_F(FrameTest, AnotherFrameBackgroundOrSizeIsAnotherImage) {
    const voctree::VOctree tree = random_tree({.seed = 2, .node_levels = 2, .leaves = 900, .bases = 5});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    render::FrameRenderer cached(device(), field, {kWidth, kHeight, 2});
    const stage::Camera camera = views(tree)[0].camera;
    const auto render = [&](render::FrameRenderer& renderer, float frame, uint32_t samples, glm::vec4 background,
                            render::Show show) {
        render::FrameSettings settings{.instances = {{frame}}, .width = kWidth, .height = kHeight, .samples = samples};
        settings.resolve = {.show = show, .background = background, .depth_near_m = 1, .depth_far_m = 6};
        return renderer.render(camera, settings).rgba;
    };
    const glm::vec4 clear(0), white(1), red(1, 0, 0, 0.5f);
    std::pmr::vector<uint8_t> last;
    for (const auto& [frame, samples, background, show] :
         {std::tuple(0.0f, 1u, clear, render::Show::kColour), std::tuple(2.5f, 1u, clear, render::Show::kColour),
          std::tuple(2.5f, 1u, white, render::Show::kColour), std::tuple(2.5f, 2u, white, render::Show::kColour),
          std::tuple(2.5f, 2u, red, render::Show::kColour), std::tuple(2.5f, 2u, red, render::Show::kDepth),
          std::tuple(2.5f, 2u, red, render::Show::kAlpha)}) {
        render::FrameRenderer fresh(device(), field, {kWidth, kHeight, 2});
        const std::pmr::vector<uint8_t> image = render(cached, frame, samples, background, show);
        EXPECT_EQ(image, render(fresh, frame, samples, background, show));
        EXPECT_NE(image, last);
        last = image;
    }
}

// A frame clears and draws only tiles that its instances may cover, or those of the last frame may have covered.
TEST_F(FrameTest, NothingOfTheLastImageStays) {
    const voctree::VOctree tree = random_tree({.seed = 2, .node_levels = 2, .leaves = 900, .bases = 5});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const stage::Camera first = views(tree)[0].camera, second = views(tree)[1].camera;
    const std::vector<render::Instance> one{{0}};
    std::vector<render::Instance> merged{{0}, {0}};
    merged[1].world_from_performer[3] = {0.3f, 0.1f, 0, 1};
    struct Step {
        std::vector<stage::Camera> cameras;
        std::vector<render::Instance> instances;
        render::Show show = render::Show::kColour;
        double scale = 1;
        std::vector<render::Fovea> foveae = {};
    };
    const auto colour = render::Show::kColour;
    const std::vector<Step> steps{{{first}, one},         {{second}, one},
                                  {{second}, {}},         {{first}, merged},
                                  {{first}, {}},          {{first}, one, render::Show::kLevel},
                                  {{second}, one},        {{second}, merged, colour, 0.5},
                                  {{first, second}, one}, {{first}, one, colour, 0.7, {{{0.3, 0.3}, {0.7, 0.7}, 0.5}}},
                                  {{second}, one}};
    const render::FrameCapacity capacity{.width = kWidth, .height = kHeight, .views = 2};
    render::FrameRenderer cached(device(), {&field}, capacity);
    for (size_t i = 0; i < steps.size(); ++i) {
        render::FrameSettings settings{.instances = steps[i].instances, .width = kWidth, .height = kHeight};
        settings.resolve.show = steps[i].show;
        settings.scale = steps[i].scale;
        settings.foveae = steps[i].foveae;
        render::FrameRenderer fresh(device(), {&field}, capacity);
        const auto drawn = [&](render::FrameRenderer& renderer) {
            const gpu::Buffer& image = renderer.draw(steps[i].cameras, settings);
            std::vector<uint32_t> pixels(steps[i].cameras.size() * kWidth * kHeight);
            gpu::download(device(), image, pixels.data(), pixels.size() * sizeof(uint32_t));
            return pixels;
        };
        EXPECT_EQ(drawn(cached), drawn(fresh)) << "step " << i;
        EXPECT_EQ(cached.radiance(), fresh.radiance()) << "step " << i;
    }
}

bool has_sliced(const render::FrameRenderer& renderer) {
    const std::vector<gpu::PassTime> passes = renderer.pass_times();
    return std::any_of(passes.begin(), passes.end(),
                       [](const gpu::PassTime& pass) { return pass.name.starts_with("slice"); });
}

TEST_F(FrameTest, SlicesShownLastAreKeptWithinTheBudget) {
    const voctree::VOctree tree = random_tree({.seed = 9, .node_levels = 2, .leaves = 900, .frames = 6});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const stage::Camera camera = views(tree)[0].camera;
    const auto render = [&](render::FrameRenderer& renderer, float frame) {
        return renderer.render(camera, {.instances = {{frame}}, .width = kWidth, .height = kHeight}).rgba;
    };
    const uint64_t one = render::slice_bytes(field, render::max_entries(field));
    for (const uint32_t slices : {1u, 2u, 3u}) {
        render::FrameRenderer renderer(device(), field, {kWidth, kHeight, 1, 1, slices * one});
        render::FrameRenderer reference(device(), field, {kWidth, kHeight, 1, 1, 1});
        std::vector<float> cached;  // the frames of the cached slices, the last used one first
        for (const float frame : {0.0f, 1.0f, 0.0f, 2.5f, 0.0f, 1.0f, 2.5f, 2.5f, 5.0f, 1.0f, 0.0f}) {
            EXPECT_EQ(render(renderer, frame), render(reference, frame)) << slices << " slices, frame " << frame;
            const auto found = std::find(cached.begin(), cached.end(), frame);
            EXPECT_EQ(has_sliced(renderer), found == cached.end()) << slices << " slices, frame " << frame;
            if (found != cached.end()) cached.erase(found);
            cached.insert(cached.begin(), frame);
            cached.resize(std::min<size_t>(cached.size(), slices));
        }
        EXPECT_EQ(renderer.slices().performer()->slices()->trees().slices, slices);
    }
}

// At first there is room for about a quarter of a clip's leaves.
TEST_F(FrameTest, AFrameInWhichAllLeavesLiveFindsRoom) {
    voctree::VOctree tree = random_tree({.seed = 6, .node_levels = 6, .leaves = 9000, .bases = 3});
    for (float& row : tree.sigma_basis) row = std::abs(row) + 0.01f;
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
        for (uint32_t c = 0; c < tree.bases; ++c) tree.leaf(leaf)[c] = std::abs(tree.leaf(leaf)[c]) + 0.01f;
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
    ASSERT_GT(field.leaf_count, render::max_entries(field) / 4 + 4096);
    Renderers renderers(device(), field);
    expect_agreement(tree, views(tree)[0], renderers, 1.3f);

    render::FrameRenderer submitted(device(), field, {kWidth, kHeight});
    const stage::Camera camera = views(tree)[0].camera;
    const render::FrameSettings settings{.instances = {{1.3f}}, .width = kWidth, .height = kHeight};
    submitted.submit({&camera, 1}, settings);
    EXPECT_FALSE(submitted.finish()) << "nobody waited, so that it was not drawn again";
    submitted.submit({&camera, 1}, settings);
    EXPECT_TRUE(submitted.finish());
    EXPECT_TRUE(submitted.finish()) << "of nothing";
    EXPECT_EQ(submitted.live_entries(), renderers.frames.live_entries());
}

TEST_F(FrameTest, ARendererRefusesLargerImages) {
    const voctree::VOctree tree = random_tree({.seed = 6, .leaves = 20});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
    render::FrameRenderer renderer(device(), field, {16, 16});
    render::FrameSettings settings;
    settings.width = 16;
    settings.height = 17;
    EXPECT_THROW(renderer.render(look_at({3, 3, 3}, {0, 0, 0}, 16, 17), settings), RuntimeFailure);
    render::ReferenceRenderer reference(device(), field, 16, 16);
    EXPECT_THROW(reference.render(look_at({3, 3, 3}, {0, 0, 0}, 16, 17), {}), RuntimeFailure);
    EXPECT_THROW(reference.render(look_at({3, 3, 3}, {0, 0, 0}, 16, 16), {.samples = 2}), RuntimeFailure);
}

// A trained volume: NEUVV_TEST_NVV=scene.nvv render_test --gtest_filter='*RealTree*'
TEST_F(FrameTest, ARealTreeMatchesTheReference) {
    const char* file = std::getenv("NEUVV_TEST_NVV");
    if (!file || !*file) GTEST_SKIP() << "set NEUVV_TEST_NVV to a trained .nvv";
    const voctree::VOctree tree = voctree::read_nvv(file);
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    Renderers renderers(device(), field);
    const float frame = 0.5f * static_cast<float>(tree.frames - 1) + 0.3f;
    const glm::dvec3 centre = world_of(tree, glm::dvec3(0.5));
    const double radius_m = 1.2 * glm::length(glm::dvec3(tree.box_size));
    for (const glm::dvec3 from : {glm::dvec3(0.3, 0.2, 1), glm::dvec3(-0.9, 0.1, -0.4), glm::dvec3(0.5, 0.9, -0.6)}) {
        const stage::Camera camera = look_at(centre + radius_m * glm::normalize(from), centre, kWidth, kHeight, 1.4);
        const Traced truth = trace_by_reference(tree, camera, frame, 0);
        const float stop = render::kStopTransmittance;
        for (const Traced& traced :
             {trace_by_path(renderers.references, camera, frame, render::ReferencePath::kSlots, stop),
              trace_by_path(renderers.references, camera, frame, render::ReferencePath::kDirect, stop),
              trace_on_device(renderers.frames, camera, frame, render::TraceMode::kTree, stop)}) {
            const Difference found = difference(traced, truth);
            EXPECT_LE(found.steps, 1);
            EXPECT_LE(found.depth_m, 1e-2);  // the mean depth includes what early termination leaves out
            EXPECT_GT(found.alpha_mean, 0.001) << "this camera sees nothing";
        }
    }
}

// The comparison must notice a wrong pixel of any kind.
TEST(FrameComparison, NoticesOneWrongPixel) {
    Traced truth{std::vector<glm::vec4>(9, glm::vec4(0.2f, 0.3f, 0.4f, 0.5f)), std::vector<float>(9, 2.0f)};
    EXPECT_EQ(difference(truth, truth).steps, 0);
    Traced wrong = truth;
    wrong.radiance[4].b += 0.01f;
    EXPECT_GT(difference(wrong, truth).steps, 1);
    wrong = truth;
    wrong.radiance[3].a = NAN;
    EXPECT_FALSE(difference(wrong, truth).steps <= 1);
    wrong = truth;
    wrong.depth[0] += 0.01f;
    EXPECT_GT(difference(wrong, truth).depth_m, kDepth_m);
    wrong.depth[0] = INFINITY;
    EXPECT_FALSE(difference(wrong, truth).depth_class);
}

}  // namespace
}  // namespace neuvv::test::frame_test
