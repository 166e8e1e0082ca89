// Overlapping instances, merged in depth order, against brute force; and the draw order of instances that do not
// overlap.
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "base/error.h"
#include "reference/merge.h"
#include "reference/trace.h"
#include "render/volume/draw_order.h"
#include "support/gpu_test.h"
#include "support/look_at.h"
#include "support/random_tree.h"
#include "support/traced.h"

namespace neuvv::test::merge_test {
namespace {

constexpr uint32_t kWidth = 61, kHeight = 43;

using MergeTest = GpuTest;

// A pixel's ray through all instances as one medium.
reference::RayResult march_together(const std::vector<const voctree::VOctree*>& trees,
                                    const std::vector<render::Instance>& instances,
                                    const std::vector<std::vector<reference::LeafSlice>>& slices,
                                    const reference::Ray& ray) {
    std::vector<std::vector<reference::Sample>> all;
    for (size_t i = 0; i < instances.size(); ++i) {
        const glm::dmat4 performer_from_world = glm::inverse(glm::dmat4(instances[i].world_from_performer));
        reference::Ray own = ray;
        own.origin = glm::dvec3(performer_from_world * glm::dvec4(ray.origin, 1));
        const glm::dvec3 direction = glm::dmat3(performer_from_world) * ray.direction;
        own.direction = glm::normalize(direction);
        all.push_back(reference::in_world(reference::ray_samples(*trees[instances[i].field], slices[i], own),
                                          1 / glm::length(direction), double{instances[i].opacity},
                                          double{instances[i].density}));
    }
    return reference::composite(reference::merge(all));
}

Traced together_by_reference(const std::vector<const voctree::VOctree*>& trees,
                             const std::vector<render::Instance>& instances, const stage::Camera& camera) {
    std::vector<std::vector<reference::LeafSlice>> slices;
    for (const render::Instance& instance : instances)
        slices.push_back(reference::slice_tree(*trees[instance.field], instance.frame));
    Traced traced;
    for (uint32_t y = 0; y < camera.height; ++y)
        for (uint32_t x = 0; x < camera.width; ++x) {
            const reference::RayResult ray =
                march_together(trees, instances, slices, reference::camera_ray(camera, x, y));
            traced.radiance.emplace_back(glm::vec3(ray.colour), static_cast<float>(ray.alpha));
            traced.depth.push_back(static_cast<float>(ray.depth_m));
        }
    return traced;
}

// Three overlapping instances of two fields, one of them translucent and thinned; one instance before them and a denser
// one behind.
std::vector<render::Instance> a_crowd() {
    return {{1.3f, glm::mat4(1), 0, 0, 1},
            {0.0f, placed({0.4f, 0.2f, -0.3f}, 0.7f, glm::vec3(1.2f, 0.8f, 1)), 0, 1, 1},
            {2.0f, placed({-0.5f, 0.1f, 0.2f}, -1.1f, glm::vec3(-0.9f, 0.9f, 1.1f)), 0, 0, 0.6f, 0.7f},
            {3.0f, placed({0.8f, 0.3f, 4}, 0.2f, glm::vec3(0.5f)), 0, 1, 0.7f},
            {0.5f, placed({-1, 0.3f, -5}, 2, glm::vec3(2)), 0, 0, 1, 1.5f}};
}

render::FrameSettings settings_of(std::vector<render::Instance> instances, render::Blend blend) {
    render::FrameSettings settings;
    settings.instances = std::move(instances);
    settings.width = kWidth;
    settings.height = kHeight;
    settings.blend = blend;
    settings.stop = 0;
    return settings;
}

stage::Camera crowd_camera() {
    return look_at({1.2, 1.5, 8}, {0, 0.4, 0}, kWidth, kHeight, 0.9);
}

struct Crowd {
    voctree::VOctree first = random_tree({.seed = 3, .node_levels = 3, .leaves = 1500, .bases = 5, .hh_degree = 2});
    voctree::VOctree second = random_tree({.seed = 9, .node_levels = 2, .leaves = 400, .bases = 4, .hh_degree = 1});
    std::vector<const voctree::VOctree*> trees{&first, &second};
    render::Field fields[2];
    explicit Crowd(const gpu::Device& device)
        : fields{render::upload_field(device, first, render::WeightPrecision::kHalf),
                 render::upload_field(device, second, render::WeightPrecision::kHalf)} {}
};

TEST_F(MergeTest, InstancesThatStandInEachOtherAreOneMedium) {
    const Crowd crowd(device());
    const Traced truth = together_by_reference(crowd.trees, a_crowd(), crowd_camera());
    for (const uint64_t budget : {render::kSliceBudget, uint64_t{0}}) {
        SCOPED_TRACE("slice budget " + std::to_string(budget));
        render::FrameRenderer renderer(device(), {&crowd.fields[0], &crowd.fields[1]}, {kWidth, kHeight, 1, 1, budget});
        renderer.render(crowd_camera(), settings_of(a_crowd(), render::Blend::kExact));
        ASSERT_EQ(renderer.plan().drawn.size(), 3u);
        EXPECT_EQ(renderer.plan().drawn[0].size(), 1u);
        EXPECT_EQ(renderer.plan().drawn[1].size(), 3u);
        EXPECT_EQ(passes(renderer, "merge"), 1u);
        const Difference found = difference({renderer.radiance(), renderer.depth()}, truth);
        EXPECT_LE(found.steps, kHalfSteps);
        EXPECT_LE(found.depth_m, 10 * kDepth_m) << "13 m away, densities as fp16";
        EXPECT_TRUE(found.depth_class);
        EXPECT_GT(found.alpha_mean, 0.1);
    }
}

// The paper's algorithm must be right for layers that do not overlap; it is not for overlapping instances.
TEST_F(MergeTest, ThePapersBlendIsWrongWhereInstancesStandInEachOther) {
    const Crowd crowd(device());
    const Traced truth = together_by_reference(crowd.trees, a_crowd(), crowd_camera());
    render::FrameRenderer renderer(device(), {&crowd.fields[0], &crowd.fields[1]}, {kWidth, kHeight});
    renderer.render(crowd_camera(), settings_of(a_crowd(), render::Blend::kPaper));
    EXPECT_EQ(passes(renderer, "merge"), 0u);
    const Difference found = difference({renderer.radiance(), renderer.depth()}, truth);
    EXPECT_GT(found.steps, 10);
    RecordProperty("worst_steps_of_255", std::to_string(found.steps));
    double mean = 0;
    for (size_t i = 0; i < truth.radiance.size(); ++i)
        mean += glm::length(glm::vec3(renderer.radiance()[i]) - glm::vec3(truth.radiance[i]));
    RecordProperty("mean_linear", std::to_string(mean / static_cast<double>(truth.radiance.size())));
}

// More intervals than there is room for at first.
constexpr uint32_t kSide = 256;

voctree::VOctree a_thicket() {
    return random_tree({.seed = 3, .node_levels = 4, .leaves = 60000, .bases = 5, .hh_degree = 0});
}

stage::Camera thicket_camera() {
    return look_at({0, 0.5, 2.2}, {0, 0.5, 0}, kSide, kSide, 1);
}

render::FrameSettings thicket_settings() {
    render::FrameSettings settings = settings_of(
        {{0}, {1, placed({0.1f, 0, 0}, 0.1f, glm::vec3(1))}, {2, placed({-0.1f, 0, 0.1f}, 0.2f, glm::vec3(1))}},
        render::Blend::kExact);
    settings.width = settings.height = kSide;
    return settings;
}

TEST_F(MergeTest, IntervalsFindRoom) {
    const voctree::VOctree tree = a_thicket();
    const render::Field field = render::upload_field(device(), tree, render::WeightPrecision::kHalf);
    const stage::Camera camera = thicket_camera();
    render::FrameSettings settings = thicket_settings();
    render::FrameRenderer renderer(device(), field, {kSide, kSide});
    renderer.render(camera, settings);
    const std::vector<glm::vec4> grown = renderer.radiance();
    const stage::Camera part = look_at({0, 0.5, 2.2}, {0, 0.5, 0}, 16, 16, 1);  // has few enough intervals at once
    settings.width = settings.height = 16;
    const Traced truth = together_by_reference({&tree}, settings.instances, part);
    renderer.render(part, settings);
    EXPECT_LE(difference({renderer.radiance(), renderer.depth()}, truth).steps, kHalfSteps);
    settings.width = settings.height = kSide;
    renderer.render(camera, settings);
    EXPECT_EQ(grown, renderer.radiance()) << "what was rendered while room was found is what is rendered with room";
    double mean_alpha = 0;
    for (const glm::vec4& ray : grown) mean_alpha += static_cast<double>(ray.a) / (kSide * kSide);
    EXPECT_GT(mean_alpha, 0.3);
}

// An instance apart from the others is drawn by other passes; these must not stay bound to the buffers that were too
// small.
TEST_F(MergeTest, AnInstanceBesideAGroupSeesRoomGrow) {
    const render::Field field = render::upload_field(device(), a_thicket(), render::WeightPrecision::kHalf);
    render::FrameSettings settings = thicket_settings();
    settings.instances.push_back({1, placed({0, 0, -9}, 0.3f, glm::vec3(2))});
    render::FrameRenderer grows(device(), field, {kSide, kSide});
    grows.render(thicket_camera(), settings);
    ASSERT_EQ(grows.plan().drawn.size(), 2u);
    EXPECT_EQ(grows.plan().drawn[1].size(), 1u);
    const std::vector<glm::vec4> grown = grows.radiance();
    grows.render(thicket_camera(), settings);
    EXPECT_EQ(grows.radiance(), grown);
    render::FrameCapacity tight_capacity{kSide, kSide};
    tight_capacity.interval_budget = uint64_t{4} << 20;
    render::FrameRenderer tight(device(), field, tight_capacity);
    tight.render(thicket_camera(), settings);
    EXPECT_EQ(tight.radiance(), grown);
}

TEST_F(MergeTest, RaysGoInBandsWhereIntervalsFindNoRoom) {
    const render::Field field = render::upload_field(device(), a_thicket(), render::WeightPrecision::kHalf);
    render::FrameRenderer roomy(device(), field, {kSide, kSide});
    roomy.render(thicket_camera(), thicket_settings());
    EXPECT_EQ(passes(roomy, "merge"), 1u);
    render::FrameCapacity tight_capacity{kSide, kSide};
    tight_capacity.interval_budget = uint64_t{4} << 20;
    render::FrameRenderer tight(device(), field, tight_capacity);
    tight.render(thicket_camera(), thicket_settings());
    EXPECT_GE(passes(tight, "merge"), 4u);
    EXPECT_EQ(tight.radiance(), roomy.radiance());
    EXPECT_EQ(tight.depth(), roomy.depth());
    tight_capacity = {32, 32};
    tight_capacity.interval_budget = uint64_t{4} << 10;
    render::FrameRenderer hopeless(device(), field, tight_capacity);
    render::FrameSettings small = thicket_settings();
    small.width = small.height = 32;
    try {
        hopeless.render(look_at({0, 0.5, 2.2}, {0, 0.5, 0}, 32, 32, 1), small);
        FAIL() << "a tile has more intervals than fit in 4 KiB";
    } catch (const RuntimeFailure& failure) {
        EXPECT_NE(std::string(failure.what()).find("the paper's blending"), std::string::npos) << failure.what();
    }
}

TEST_F(MergeTest, AnOpacityOfOneIsTheSolidInstanceAndOfNoneIsNothing) {
    const Crowd crowd(device());
    render::FrameRenderer renderer(device(), {&crowd.fields[0], &crowd.fields[1]}, {kWidth, kHeight});
    const auto radiance = [&](float opacity) {
        renderer.render(crowd_camera(), settings_of({{1.3f, glm::mat4(1), 0, 0, opacity}}, render::Blend::kExact));
        return renderer.radiance();
    };
    const std::vector<glm::vec4> solid = radiance(1), half = radiance(0.5f);
    for (size_t i = 0; i < solid.size(); ++i) EXPECT_LE(glm::length(half[i] - 0.5f * solid[i]), 1e-6f) << "ray " << i;
    for (const glm::vec4& ray : radiance(0)) EXPECT_EQ(ray, glm::vec4(0));
}

// What a clip shows while one of its intervals fades into the next.
TEST_F(MergeTest, SharesOfTheDensityAreTheWhole) {
    const Crowd crowd(device());
    render::FrameRenderer renderer(device(), {&crowd.fields[0], &crowd.fields[1]}, {kWidth, kHeight});
    const auto traced = [&](std::vector<render::Instance> instances) {
        renderer.render(crowd_camera(), settings_of(std::move(instances), render::Blend::kExact));
        return Traced{renderer.radiance(), renderer.depth()};
    };
    const Traced whole = traced({{1.3f, glm::mat4(1)}});
    const Traced shares = traced({{1.3f, glm::mat4(1), 0, 0, 1, 0.3f}, {1.3f, glm::mat4(1), 0, 0, 1, 0.7f}});
    EXPECT_LE(difference(shares, whole).steps, kHalfSteps);
    EXPECT_GT(difference(traced({{1.3f, glm::mat4(1), 0, 0, 1, 0.3f}}), whole).steps, 5);
    for (const glm::vec4& ray : traced({{1.3f, glm::mat4(1), 0, 0, 1, 0}}).radiance) EXPECT_EQ(ray, glm::vec4(0));
}

render::TransformedBox box_at(glm::dvec3 at, double turn = 0, glm::dvec3 half = glm::dvec3(0.5)) {
    const glm::dmat4 transform = glm::rotate(glm::translate(glm::dmat4(1), at), turn, glm::dvec3(0, 1, 0));
    return render::transformed_box(-half, half, transform);
}

using Groups = std::vector<std::vector<uint32_t>>;

TEST(DrawOrder, IsNearToFarWhereBoxesStandApart) {
    const std::vector<render::TransformedBox> row = {box_at({0, 0, -6}), box_at({0, 0, -2}), box_at({0, 0, -4})};
    EXPECT_EQ(render::draw_order(row, std::vector{glm::dvec3(0)}), (Groups{{1}, {2}, {0}}));
    EXPECT_EQ(render::draw_order(row, std::vector{glm::dvec3(0, 0, -10)}), (Groups{{0}, {2}, {1}}));
    EXPECT_EQ(render::draw_order({}, std::vector{glm::dvec3(0)}), Groups{});
}

// A long wall, whose centre is nearer than a box before its far end.
TEST(DrawOrder, IsNotThatOfCentres) {
    const render::TransformedBox wall = box_at({0, 0, -5}, 0, {20, 1, 0.1}), before = box_at({15, 0, -4});
    EXPECT_EQ(render::draw_order(std::vector{wall, before}, std::vector{glm::dvec3(0)}), (Groups{{1}, {0}}));
}

TEST(DrawOrder, BoxesThatOverlapAreOneGroup) {
    const std::vector<render::TransformedBox> boxes = {box_at({0, 0, -5}), box_at({0.9, 0, -5}), box_at({1.8, 0, -5}),
                                                       box_at({3, 0, -5})};
    EXPECT_EQ(render::draw_order(boxes, std::vector{glm::dvec3(0)}), (Groups{{0, 1, 2}, {3}}));
    // Touching is not overlapping.
    EXPECT_EQ(
        render::draw_order(std::vector{box_at({0, 0, -5}), box_at({0, 0, -6})}, std::vector{glm::dvec3(0)}).size(), 2u);
}

TEST(DrawOrder, TurnedBoxesPartAlongAnEdgeOfEach) {
    // Boxes whose axis-aligned bounds overlap.
    const std::vector<render::TransformedBox> boxes = {box_at({0, 0, -5}, std::numbers::pi / 4),
                                                       box_at({1.15, 0, -5.75}, 0.9)};
    EXPECT_EQ(render::draw_order(boxes, std::vector{glm::dvec3(0)}), (Groups{{0}, {1}}));
}

// Three beams, each before the next one at one end and behind the third one at the other.
TEST(DrawOrder, BoxesThatCoverEachOtherInACircleAreOneGroup) {
    std::vector<render::TransformedBox> beams;
    for (int i = 0; i < 3; ++i) {
        const double angle = 2 * std::numbers::pi * i / 3;
        const glm::dvec3 along(std::cos(angle), std::sin(angle), 0.35), across(-std::sin(angle), std::cos(angle), 0);
        const glm::dvec3 centre = glm::dvec3(0, 0, -8) + 0.6 * across;
        beams.push_back({centre, glm::dmat3(2.0 * along, 0.12 * across, glm::dvec3(0, 0, 0.05))});
    }
    EXPECT_EQ(render::draw_order(beams, std::vector{glm::dvec3(0)}).size(), 1u);
    beams.pop_back();
    EXPECT_EQ(render::draw_order(beams, std::vector{glm::dvec3(0)}).size(), 2u);
}

TEST(DrawOrder, MustHoldForAllEyes) {
    const std::vector<render::TransformedBox> pair = {box_at({-1, 0, 0}), box_at({1, 0, 0})};
    EXPECT_EQ(render::draw_order(pair, std::vector{glm::dvec3(-5, 0, 0), glm::dvec3(-5, 0, 1)}), (Groups{{0}, {1}}));
    EXPECT_EQ(render::draw_order(pair, std::vector{glm::dvec3(-5, 0, 0), glm::dvec3(5, 0, 0)}), (Groups{{0, 1}}));
}

// Random boxes and lines: what a line meets first is not in a later group.
TEST(DrawOrder, HoldsAlongEveryLine) {
    Random random(5);
    uint32_t met = 0, groups_of_one = 0;
    for (int scene = 0; scene < 20; ++scene) {
        std::vector<render::TransformedBox> boxes;
        for (int i = 0; i < 12; ++i) {
            const auto vector = [&](double size) {
                return glm::dvec3(random.uniform(-size, size), random.uniform(-size, size),
                                  random.uniform(-size, size));
            };
            const glm::dvec3 centre = vector(4);
            boxes.push_back({centre, glm::dmat3(vector(1), vector(1), vector(1))});
        }
        const glm::dvec3 eye(0, 0, 9);
        const Groups groups = render::draw_order(boxes, std::vector{eye});
        for (const auto& group : groups) groups_of_one += group.size() == 1;
        for (int line = 0; line < 300; ++line) {
            const glm::dvec3 direction =
                glm::normalize(glm::dvec3(random.uniform(-3, 3), random.uniform(-3, 3), random.uniform(-4, 4)) - eye);
            double end_of_nearer = 0;
            for (const auto& group : groups) {
                double begin = INFINITY, end = -INFINITY;
                for (const uint32_t i : group) {
                    // The slab test in the axes of the box.
                    const glm::dmat3 own = glm::inverse(boxes[i].half);
                    const glm::dvec3 origin = own * (eye - boxes[i].centre), along = own * direction;
                    const glm::dvec3 a = (-1.0 - origin) / along, b = (1.0 - origin) / along;
                    const glm::dvec3 low = glm::min(a, b), high = glm::max(a, b);
                    const double first = std::max({low.x, low.y, low.z, 0.0});
                    const double last = std::min({high.x, high.y, high.z});
                    if (first >= last) continue;
                    begin = std::min(begin, first);
                    end = std::max(end, last);
                    ++met;
                }
                if (begin > end) continue;
                EXPECT_GE(begin, end_of_nearer - 1e-9) << "scene " << scene << ", line " << line;
                end_of_nearer = std::max(end_of_nearer, end);
            }
        }
    }
    EXPECT_GT(met, 1000u);
    EXPECT_GT(groups_of_one, 20u);
}

}  // namespace
}  // namespace neuvv::test::merge_test
