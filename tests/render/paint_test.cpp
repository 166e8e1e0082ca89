// Paint on slice trees against the reference, entry by entry; and images of painted and unpainted instances.
#include "render/volume/slices/paint.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "base/error.h"
#include "reference/paint.h"
#include "support/gpu_test.h"
#include "support/host_tree.h"
#include "support/look_at.h"
#include "support/random_layer.h"
#include "support/traced.h"

namespace neuvv::test::paint_test {
namespace {

constexpr uint32_t kBlends = 4;

double as_half(double value) {
    return double{voctree::float_from_half(voctree::half_from_float(static_cast<float>(value)))};
}

// Blends of edits that cover each other, so that colours do not have few bits.
void round_to_halves(voctree::EditLayer& layer) {
    for (voctree::LeafEdit& edit : layer.edits) {
        for (int c = 0; c < 3; ++c) edit.colour[c] = static_cast<float>(as_half(double{edit.colour[c]}));
        edit.alpha = static_cast<float>(as_half(double{edit.alpha}));
    }
}

// In fp16, as entries have them before paint.
std::vector<reference::LeafSlice> slices_in_halves(const voctree::VOctree& tree, double frame) {
    std::vector<reference::LeafSlice> slices = reference::slice_tree(tree, frame);
    for (reference::LeafSlice& leaf : slices)
        for (auto& channel : leaf.k)
            for (double& k : channel) k = as_half(k);
    return slices;
}

struct PaintTest : GpuTest {
    // The largest error of the painted tree's entries, in units of the tolerance.
    static double worst_entry(const voctree::VOctree& tree, const std::vector<render::PaintUse>& uses, float frame,
                              bool in_parts, const std::vector<render::PaintUse>& expected_uses) {
        const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kFloat);
        const render::LiveLeaves live(device(), field, field.leaf_count);
        const render::SliceTrees sliced(device(), field, render::max_entries(field), 1);
        const render::TreeSlicer slicer(device(), field, live, sliced);
        const render::Paint paint(device(), tree.leaf_count, uses);
        const render::Painter painter(device(), field, live, sliced);
        const render::SlicePaint bound(painter, paint);
        gpu::run_once(device(), "slice", [&](gpu::Commands& commands) {
            if (!in_parts) render::record_slice_tree(commands, slicer, 0, frame, &bound);
            for (uint32_t part = 0; in_parts && part < render::kSliceParts; ++part)
                render::record_slice_part(commands, slicer, 0, frame, part, &bound);
        });
        const HostTree host = download_tree(device(), field, sliced);
        std::vector<reference::LeafSlice> truth = slices_in_halves(tree, double{frame});
        std::vector<reference::PaintStep> steps;
        for (const render::PaintUse& use : expected_uses)
            steps.push_back({use.layer, static_cast<uint32_t>(use.blend), double{use.opacity}});
        reference::paint(truth, tree.hh_degree, steps, double{frame});
        TreeCheck check{host, tree, truth};
        check.min_scale = 4;  // terms may cancel where a colour becomes grey
        check.visit(0, 0);
        for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
            EXPECT_EQ(check.met[leaf], truth[leaf].sigma > 0) << "leaf " << leaf;
        EXPECT_EQ(check.entries, host.count.slots);
        // fp16 rounds numbers by up to 2^-11 of their value, before and after paint. Mean colours are compared as
        // colours, not as logits, whose differences near white or black are invisible. 2^-11 is an eighth of a step of
        // 255.
        return std::max(check.worst_rest / 0x1p-10, check.worst_mean / 0x1p-11);
    }
};

constexpr double kWorstEntry = 1;

TEST_F(PaintTest, EveryEntryIsAsTheReferencePaintsIt) {
    constexpr uint32_t kLevels[] = {1, 2, 4, 3};
    for (uint32_t degree = 0; degree <= kMaxHhDegree; ++degree) {
        const voctree::VOctree tree = random_tree(
            {.seed = degree + 40, .node_levels = kLevels[degree], .leaves = 600, .bases = 5, .hh_degree = degree});
        Random random(degree);
        std::vector<voctree::EditLayer> layers;
        for (uint32_t i = 0; i < kBlends; ++i) layers.push_back(random_layer(tree, random));
        for (voctree::EditLayer& layer : layers) round_to_halves(layer);
        for (uint32_t mode = 0; mode < kBlends; ++mode)
            for (const float frame : {0.0f, 2.5f, 4.0f}) {
                SCOPED_TRACE(testing::Message() << "degree " << degree << " blend " << mode << " frame " << frame);
                const std::vector<render::PaintUse> one = {{&layers[mode], static_cast<stage::PaintBlend>(mode), 1}};
                EXPECT_LE(worst_entry(tree, one, frame, false, one), kWorstEntry);
            }
        const std::vector<render::PaintUse> all = {{&layers[0], stage::PaintBlend::kTint, 0.75f},
                                                   {&layers[1], stage::PaintBlend::kNormal, 0.5f},
                                                   {&layers[2], stage::PaintBlend::kRecolour, 1},
                                                   {&layers[3], stage::PaintBlend::kMultiply, 0.25f}};
        for (const bool in_parts : {false, true})
            EXPECT_LE(worst_entry(tree, all, 1.5f, in_parts, all), kWorstEntry) << "degree " << degree;
    }
}

// Devices may take a denormal, as the frame just behind 0 is, for 0.
TEST_F(PaintTest, WhatBeginsJustBehindFrame0DoesNotApplyThere) {
    const voctree::VOctree tree = random_tree({.leaves = 200, .bases = 3});
    voctree::EditLayer behind{voctree::painted_field(tree), {}};
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
        behind.edits.push_back({leaf, std::numeric_limits<float>::denorm_min(), 1, {0, 0, 1}, 1, voctree::kKeepSigma});
    voctree::EditLayer from_0 = behind;
    for (voctree::LeafEdit& edit : from_0.edits) edit.first = -0.0f;
    EXPECT_LE(worst_entry(tree, {{&behind}}, 0, false, {}), kWorstEntry);
    EXPECT_LE(worst_entry(tree, {{&behind}}, 0.5f, false, {{&behind}}), kWorstEntry);
    EXPECT_LE(worst_entry(tree, {{&from_0}}, 0, false, {{&from_0}}), kWorstEntry);
}

TEST_F(PaintTest, TheComparisonNoticesAnotherBlendOrOrderOrOpacity) {
    const voctree::VOctree tree = random_tree({.seed = 7, .node_levels = 2, .leaves = 300, .hh_degree = 1});
    Random random(7);
    voctree::EditLayer a = random_layer(tree, random), b = random_layer(tree, random);
    for (voctree::LeafEdit& edit : a.edits) edit.sigma = voctree::kKeepSigma;
    b.edits = a.edits;
    for (voctree::LeafEdit& edit : b.edits) edit.colour = 1.0f - edit.colour;
    round_to_halves(a);
    round_to_halves(b);
    const std::vector<render::PaintUse> used = {{&a, stage::PaintBlend::kTint, 0.5f},
                                                {&b, stage::PaintBlend::kNormal, 0.5f}};
    EXPECT_LE(worst_entry(tree, used, 2, false, used), kWorstEntry);
    std::vector<render::PaintUse> wrong = used;
    wrong[0].blend = stage::PaintBlend::kRecolour;
    EXPECT_GT(worst_entry(tree, used, 2, false, wrong), 10 * kWorstEntry);
    wrong = used;
    wrong[1].opacity = 0.6f;
    EXPECT_GT(worst_entry(tree, used, 2, false, wrong), 10 * kWorstEntry);
    EXPECT_GT(worst_entry(tree, used, 2, false, {used[1], used[0]}), 10 * kWorstEntry);
}

constexpr uint32_t kWidth = 61, kHeight = 43;

stage::Camera stage_camera() {
    return look_at({0.2, 1.5, 9}, {0, 0.4, 0}, kWidth, kHeight, 1.0);
}

render::FrameSettings settings_of(std::vector<render::Instance> instances,
                                  render::TraceMode mode = render::TraceMode::kTree) {
    render::FrameSettings settings;
    settings.instances = std::move(instances);
    settings.width = kWidth;
    settings.height = kHeight;
    settings.mode = mode;
    return settings;
}

glm::mat4 at(float x) {
    return glm::translate(glm::mat4(1), {x, 0, 0});
}

struct Copies {
    voctree::VOctree tree = random_tree({.seed = 9, .node_levels = 3, .leaves = 3000, .bases = 5, .hh_degree = 1});
    voctree::EditLayer red{voctree::painted_field(tree), {}}, gone{voctree::painted_field(tree), {}};
    Copies() {
        for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) {
            red.edits.push_back({leaf, 0, 4, {1, 0, 0}, 1});
            if (leaf % 2) gone.edits.push_back({leaf, 0, 4, glm::vec3(0), 0, 0});
        }
    }
};

TEST_F(PaintTest, CopiesArePaintedEachForItselfAndTheOthersNotAtAll) {
    const Copies copies;
    const render::Field field = render::upload_field(device(), copies.tree, render::WeightPrecision::kHalf);
    render::FrameRenderer renderer(device(), field, {kWidth, kHeight}), plain(device(), field, {kWidth, kHeight});
    const render::PaintUse red{&copies.red, stage::PaintBlend::kRecolour, 1}, gone{&copies.gone};
    const uint32_t red_paint = renderer.paints().add({&red, 1}), gone_paint = renderer.paints().add({&gone, 1});
    for (const render::TraceMode mode : {render::TraceMode::kTree, render::TraceMode::kShaded}) {
        const auto alone = [&](render::FrameRenderer& with, uint32_t paint, float x) {
            return with.render(stage_camera(), settings_of({{1.5f, at(x), paint}}, mode)).rgba;
        };
        const auto truth = alone(plain, 0, 0);
        EXPECT_EQ(alone(renderer, 0, 0), truth) << "unpainted is as ever";
        EXPECT_NE(alone(renderer, red_paint, 0), truth);
        EXPECT_NE(alone(renderer, gone_paint, 0), truth);
        EXPECT_NE(alone(renderer, gone_paint, 0), alone(renderer, red_paint, 0));
        EXPECT_EQ(alone(renderer, 0, 0), truth) << "and stays so";
        // Three copies side by side: the part of the third one equals that of an image without paint.
        const std::vector<render::Instance> three = {
            {.frame = 1.5f, .world_from_performer = at(-3.2f), .paint = red_paint},
            {.frame = 1.5f, .world_from_performer = at(0), .paint = gone_paint},
            {.frame = 1.5f, .world_from_performer = at(3.2f)}};
        const media::Image with = renderer.render(stage_camera(), settings_of(three, mode));
        const media::Image without =
            plain.render(stage_camera(), settings_of({{1.5f, at(-3.2f)}, {1.5f, at(0)}, {1.5f, at(3.2f)}}, mode));
        bool same_left = true;
        for (uint32_t y = 0; y < kHeight; ++y)
            for (uint32_t x = 0; x < kWidth; ++x) {
                const bool same = std::equal(with.at(x, y), with.at(x, y) + 4, without.at(x, y));
                EXPECT_TRUE(same || x <= 46) << x << " " << y;
                if (x < 15) same_left &= same;
            }
        EXPECT_FALSE(same_left);
    }
}

TEST_F(PaintTest, IsSeenWhateverTheBudget) {
    const Copies copies;
    const render::Field field = render::upload_field(device(), copies.tree, render::WeightPrecision::kHalf);
    const render::PaintUse red{&copies.red, stage::PaintBlend::kNormal, 0.5f}, gone{&copies.gone},
        both[] = {{&copies.red}, {&copies.gone}};
    const uint64_t one = render::slice_bytes(field, render::max_entries(field));
    std::pmr::vector<uint8_t> truth;
    for (const uint64_t budget : {render::kSliceBudget, 3 * one, 2 * one, one, uint64_t{0}}) {
        SCOPED_TRACE(testing::Message() << "budget " << budget);
        render::FrameRenderer renderer(device(), field, {kWidth, kHeight, 1, 1, budget});
        render::Paints& paints = renderer.paints();
        const uint32_t ids[] = {paints.add({&red, 1}), paints.add({&gone, 1}), paints.add(both)};
        const render::FrameSettings settings = settings_of(
            {{1, at(-3), ids[0]}, {1, at(-1), ids[1]}, {1, at(1), ids[2]}, {1, at(2), ids[0]}, {2.5f, at(3), ids[0]}});
        for (int again = 0; again < 2; ++again) {
            const std::pmr::vector<uint8_t> image = renderer.render(stage_camera(), settings).rgba;
            if (truth.empty()) truth = image;
            EXPECT_EQ(image, truth);
            EXPECT_EQ(passes(renderer, "direct"), 0u);
        }
        const size_t built_again = passes(renderer, "paint colour");
        const size_t slice_count = std::clamp<size_t>(budget / one, 1, 4);
        EXPECT_GE(built_again, slice_count == 4 ? 0 : 4 - (slice_count - 1)) << "slices that share memory";
        EXPECT_LE(built_again, slice_count == 4 ? 0u : 5u) << "slices stay";
        // Then an image without paint, and one of painted and unpainted instances.
        render::FrameRenderer plain(device(), field, {kWidth, kHeight});
        EXPECT_EQ(renderer.render(stage_camera(), settings_of({{3}})).rgba.size(), truth.size());
        const render::FrameSettings mixed = settings_of({{1, at(-2), ids[1]}, {3, at(2)}});
        renderer.render(stage_camera(), mixed);
        EXPECT_EQ(passes(renderer, "direct") + passes(renderer, "trace"), 2u);
    }
    EXPECT_THROW(
        {
            render::FrameRenderer renderer(device(), field, {kWidth, kHeight});
            renderer.render(stage_camera(), settings_of({{1, at(0), 7}}));
        },
        RuntimeFailure);
}

// Paint revives nearly all leaves: more than slices have room for at first, wherever they are built.
TEST_F(PaintTest, RevivedLeavesFindRoom) {
    voctree::VOctree tree = random_tree({.seed = 12, .node_levels = 4, .leaves = 12000, .hh_degree = 1, .frames = 8});
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf) std::fill_n(tree.leaf(leaf), tree.bases, 0.0f);
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    voctree::EditLayer layer{voctree::painted_field(tree), {}};
    for (uint32_t leaf = 0; leaf < tree.leaf_count; ++leaf)
        layer.edits.push_back({leaf, 2, 3, {0, leaf % 2 ? 1.0f : 0.5f, 0}, 0.5f, 2});
    std::vector<reference::LeafSlice> slices = reference::slice_tree(tree, 2.5);
    reference::paint(slices, 1, {{&layer}}, 2.5);
    const stage::Camera camera = look_at({0.2, 1.5, 5}, {0, 0.4, 0}, kWidth, kHeight, 1.0);
    Traced truth;
    for (uint32_t y = 0; y < kHeight; ++y)
        for (uint32_t x = 0; x < kWidth; ++x) {
            const reference::RayResult ray = reference::trace(tree, slices, reference::camera_ray(camera, x, y));
            truth.radiance.emplace_back(glm::vec3(ray.colour), static_cast<float>(ray.alpha));
            truth.depth.push_back(static_cast<float>(ray.depth_m));
        }
    for (const uint64_t budget : {render::kSliceBudget, uint64_t{0}}) {
        render::FrameRenderer renderer(device(), field, {kWidth, kHeight, 1, 1, budget});
        const render::PaintUse use{&layer};
        const uint32_t paint = renderer.paints().add({&use, 1});
        render::FrameSettings settings = settings_of({{2.5f, glm::mat4(1), paint}});
        settings.stop = 0;
        renderer.render(camera, settings);
        const Difference found = difference({renderer.radiance(), renderer.depth()}, truth);
        EXPECT_LE(found.steps, kHalfSteps);
        EXPECT_GT(found.alpha_mean, 0.1);
        EXPECT_GT(renderer.slices().performer()->slices()->trees().capacity, tree.leaf_count);
        settings.instances[0].frame = 3.5f;
        renderer.render(camera, settings);
        EXPECT_EQ(renderer.radiance(), std::vector<glm::vec4>(size_t{kWidth} * kHeight)) << "past its last frame";
    }
}

TEST_F(PaintTest, SlicesBuiltAheadArePainted) {
    const Copies copies;
    const render::Field field = render::upload_field(device(), copies.tree, render::WeightPrecision::kHalf);
    render::FrameRenderer ahead(device(), field, {kWidth, kHeight}), fresh(device(), field, {kWidth, kHeight});
    const render::PaintUse uses[] = {{&copies.red, stage::PaintBlend::kTint, 1}, {&copies.gone}};
    const uint32_t paint = ahead.paints().add(uses);
    ASSERT_EQ(fresh.paints().add(uses), paint);
    render::FrameSettings settings = settings_of({{0, glm::mat4(1), paint}});
    settings.next_instances = {{2.5f, glm::mat4(1), paint}};
    settings.prefetch_parts = 1;
    for (uint32_t part = 0; part < render::kSliceParts; ++part) ahead.render(stage_camera(), settings);
    const render::FrameSettings later = settings_of({{2.5f, glm::mat4(1), paint}});
    EXPECT_EQ(ahead.render(stage_camera(), later).rgba, fresh.render(stage_camera(), later).rgba);
    EXPECT_EQ(passes(ahead, "slice nodes"), 0u) << "it was ready";
    EXPECT_EQ(passes(fresh, "paint colour"), 1u);
}

TEST_F(PaintTest, OfACopyTakesNoFieldAgain) {
    voctree::VOctree tree = random_tree({.seed = 8, .node_levels = 4, .leaves = 20000, .hh_degree = 2, .frames = 1});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    voctree::EditLayer layer{voctree::painted_field(tree), {}};
    for (uint32_t leaf = 0; leaf < tree.leaf_count; leaf += 10) layer.edits.push_back({leaf, 0, 0, {0, 0, 1}, 1});
    render::FrameRenderer renderer(device(), field,
                                   {kWidth, kHeight, 1, 1, render::slice_bytes(field, render::max_entries(field))});
    renderer.render(stage_camera(), settings_of({{}, {0, at(2)}}));
    const uint64_t before = device().buffer_bytes();
    const render::PaintUse use{&layer};
    const uint32_t paint = renderer.paints().add({&use, 1});
    renderer.render(stage_camera(), settings_of({{}, {0, at(2), paint}}));
    const uint64_t more = device().buffer_bytes() - before;
    EXPECT_LE(more, 28 * layer.edits.size() + 64);
    EXPECT_GE(more, 20 * layer.edits.size());
    EXPECT_LT(20 * more, field.whole_weights().bytes);
    renderer.paints().remove(paint);
    EXPECT_EQ(device().buffer_bytes(), before);
}

TEST_F(PaintTest, OfAnotherFieldIsRefused) {
    const voctree::VOctree tree = random_tree({.seed = 8, .leaves = 200}),
                           other = random_tree({.seed = 8, .leaves = 100});
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    render::Paints paints(device(), field);
    const voctree::EditLayer layer{voctree::painted_field(other), {}};
    const render::PaintUse use{&layer};
    EXPECT_THROW(paints.add({&use, 1}), RuntimeFailure);
    EXPECT_THROW(paints.add(std::vector<render::PaintUse>(kPaintLayerLimit + 1, use)), RuntimeFailure);
}

}  // namespace
}  // namespace neuvv::test::paint_test
