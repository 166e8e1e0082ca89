#include "xr/ray_hit.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "tests/xr/random_poses.h"

namespace neuvv {
namespace {

using test::kInfinite;
using test::kNan;
using test::RandomPoses;

const glm::dvec3 kLow(-0.5, 0, -0.25), kHigh(0.5, 1.8, 0.25);

// The distance of a world point from the box, in the box's units; 0 inside.
double outside(const glm::dmat4& box_from_world, glm::dvec3 world) {
    const glm::dvec3 there(box_from_world * glm::dvec4(world, 1));
    return glm::distance(there, glm::clamp(there, kLow, kHigh));
}

// A random transform: rotated, scaled differently along each axis, sheared, and mirrored where `mirrored` says so.
glm::dmat4 random_matrix(RandomPoses& random, bool mirrored) {
    glm::dmat4 shear(1);
    shear[1].x = random.number(-0.5, 0.5);
    const glm::dvec3 sizes(random.number(0.3, 2), random.number(0.3, 2), random.number(0.3, 2) * (mirrored ? -1 : 1));
    return xr::matrix_of(random.pose()) * shear * glm::scale(glm::dmat4(1), sizes);
}

TEST(BoxHit, IsTheFirstSampleWithin) {
    RandomPoses random(7);
    constexpr double kStep_m = 2e-3, kEnd_m = 8;
    int hits = 0, misses = 0, inside = 0;
    for (int i = 0; i < 300; ++i) {
        const glm::dmat4 world_from_box = random_matrix(random, i % 2 == 1),
                         box_from_world = glm::inverse(world_from_box);
        const glm::dvec3 seen = world_from_box * glm::dvec4(random.number(-0.8, 0.8), random.number(-0.5, 2.3), 0, 1);
        const glm::dvec3 from = random.vector(i % 5 == 0 ? 0.2 : 3) + (i % 5 == 0 ? seen : glm::dvec3(0));
        const Ray ray = {from, glm::normalize(i % 7 == 0 ? from - seen : seen - from)};
        const std::optional<double> hit = box_hit(ray, world_from_box, kLow, kHigh);
        std::optional<double> sampled;
        for (double t = 0; t < kEnd_m && !sampled; t += kStep_m)
            if (outside(box_from_world, ray.origin + ray.direction * t) == 0) sampled = t;
        if (sampled) {
            ASSERT_TRUE(hit) << i;
            EXPECT_LE(*hit, *sampled + 1e-9) << i;
        }
        if (hit && *hit < kEnd_m) {
            EXPECT_LT(outside(box_from_world, ray.origin + ray.direction * *hit), 1e-9) << i;
            EXPECT_GT(sampled.value_or(kEnd_m), *hit - 1e-9);
            if (*hit > 0) {
                EXPECT_GT(outside(box_from_world, ray.origin + ray.direction * (*hit - 1e-6)), 0) << "enters";
            }
        }
        (!hit ? misses : *hit > 0 ? hits : inside)++;
    }
    EXPECT_GT(hits, 20);
    EXPECT_GT(misses, 20);
    EXPECT_GT(inside, 5);
}

TEST(BoxHit, CountsTheWorldsMetres) {
    const glm::dmat4 large = glm::scale(glm::translate(glm::dmat4(1), {0, 0, -10}), glm::dvec3(4));
    EXPECT_NEAR(*box_hit({{0, 1, 0}, {0, 0, -1}}, large, kLow, kHigh), 9, 1e-12);
    EXPECT_NEAR(*box_hit({{0, 1, 0}, {0, 0, -5}}, large, kLow, kHigh), 9, 1e-12) << "whatever the direction's length";
    const glm::dmat4 tiny = glm::scale(glm::translate(glm::dmat4(1), {0, 0, -10}), glm::dvec3(1e-6));
    EXPECT_NEAR(*box_hit({{0, 0, 0}, {0, 0, -1}}, tiny, kLow, kHigh), 10, 1e-6) << "small is not singular";
}

TEST(BoxHit, BehindAndInside) {
    EXPECT_FALSE(box_hit({{0, 1, -1}, {0, 0, -1}}, glm::dmat4(1), kLow, kHigh));
    EXPECT_EQ(box_hit({{0, 1, 0}, {0, 0, -1}}, glm::dmat4(1), kLow, kHigh), 0.0);
    EXPECT_FALSE(box_hit({{0, 1.81, 1}, {0, 0, -1}}, glm::dmat4(1), kLow, kHigh)) << "just above";
    EXPECT_TRUE(box_hit({{0, 1.79, 1}, {0, 0, -1}}, glm::dmat4(1), kLow, kHigh));
}

TEST(BoxHit, FlatAndEmptyBoxes) {
    const Ray ray = {{0, 0.5, 1}, {0, 0, -1}};
    EXPECT_EQ(box_hit(ray, glm::dmat4(1), {-1, 0, 0}, {1, 1, 0}), 1.0) << "flat";
    EXPECT_FALSE(box_hit(ray, glm::dmat4(1), {1, 0, 0}, {-1, 1, 0})) << "empty";
    EXPECT_FALSE(box_hit(ray, glm::dmat4(1), {kNan, 0, 0}, {1, 1, 1}));
}

TEST(BoxHit, NothingOfWhatIsNoRayOrNoMatrix) {
    const Ray ray = {{0, 0.5, 1}, {0, 0, -1}};
    ASSERT_TRUE(box_hit(ray, glm::dmat4(1), kLow, kHigh));
    for (const double bad : {kNan, kInfinite, -kInfinite}) {
        EXPECT_FALSE(box_hit({{0, bad, 1}, {0, 0, -1}}, glm::dmat4(1), kLow, kHigh));
        EXPECT_FALSE(box_hit({{0, 0.5, 1}, {0, bad, -1}}, glm::dmat4(1), kLow, kHigh));
        for (int i = 0; i < 4; ++i) {
            glm::dmat4 matrix(1);
            matrix[i].y = bad;
            EXPECT_FALSE(box_hit(ray, matrix, kLow, kHigh)) << i;
        }
    }
    EXPECT_FALSE(box_hit({{0, 0.5, 0}, {0, 0, 0}}, glm::dmat4(1), kLow, kHigh));
    EXPECT_FALSE(box_hit(ray, glm::dmat4(0), kLow, kHigh));
    EXPECT_FALSE(box_hit(ray, glm::scale(glm::dmat4(1), {1, 0, 1}), kLow, kHigh)) << "flattened";
    glm::dmat4 folded(1);
    folded[1] = folded[0];
    EXPECT_FALSE(box_hit(ray, folded, kLow, kHigh)) << "two axes alike";
    folded[1].y = 1e-14;
    EXPECT_FALSE(box_hit({{0, 0, 1}, {0, 0, -1}}, folded, kLow, kHigh)) << "as good as alike";
}

TEST(RectangleHit, FindsThePointThatWasAimedAt) {
    RandomPoses random(8);
    const glm::dvec2 size_m(0.8, 0.5);
    for (int i = 0; i < 200; ++i) {
        const xr::Pose panel = random.pose();
        const glm::dmat4 axes = xr::matrix_of(panel);
        const glm::dvec2 at(random.number(-0.2, 1.2), random.number(-0.2, 1.2));
        const glm::dvec3 corner = panel.position - glm::dvec3(axes[0]) * 0.4 + glm::dvec3(axes[1]) * 0.25;
        const glm::dvec3 target = corner + glm::dvec3(axes[0]) * at.x * 0.8 - glm::dvec3(axes[1]) * at.y * 0.5;
        const double side = i % 2 == 0 ? 1 : -1;
        const glm::dvec3 eye = target + glm::dmat3(axes) * glm::dvec3(random.number(-1, 1), random.number(-1, 1), side);
        const auto hit = xr::rectangle_hit({eye, glm::normalize(target - eye)}, panel, size_m);
        const bool within = at.x >= 0 && at.x <= 1 && at.y >= 0 && at.y <= 1;
        ASSERT_EQ(hit.has_value(), within && side > 0) << i;
        EXPECT_FALSE(xr::rectangle_hit({eye, glm::normalize(eye - target)}, panel, size_m)) << "leads away";
        if (!hit) continue;
        EXPECT_LT(glm::distance(hit->uv, at), 1e-9);
        EXPECT_NEAR(hit->distance_m, glm::distance(eye, target), 1e-9);
    }
}

TEST(RectangleHit, CountsFromTheUpperLeft) {
    const auto hit = xr::rectangle_hit({{-0.9, 0.4, 3}, {0, 0, -1}}, xr::Pose{{0, 0, 1}}, {2, 1});
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->uv.x, 0.05, 1e-12);
    EXPECT_NEAR(hit->uv.y, 0.1, 1e-12);
    EXPECT_NEAR(hit->distance_m, 2, 1e-12);
}

TEST(RectangleHit, NothingOfWhatIsNone) {
    const Ray ray = {{0, 0, 1}, {0, 0, -1}};
    ASSERT_TRUE(xr::rectangle_hit(ray, {}, {1, 1}));
    for (const xr::Pose& pose : test::invalid_poses()) EXPECT_FALSE(xr::rectangle_hit(ray, pose, {1, 1}));
    for (const double bad : {kNan, 0.0, -1.0}) {
        EXPECT_FALSE(xr::rectangle_hit(ray, {}, {bad, 1}));
        EXPECT_FALSE(xr::rectangle_hit(ray, {}, {1, bad}));
    }
    EXPECT_FALSE(xr::rectangle_hit({{0, 0, 0.1}, {1, 0, 0}}, {}, {1, 1})) << "edge on";
    EXPECT_FALSE(xr::rectangle_hit({{0, 0, 0.1}, {1, 0, -1e-320}}, {}, {1, 1}));
    EXPECT_FALSE(xr::rectangle_hit({{0, kNan, 1}, {0, 0, -1}}, {}, {1, 1}));
    EXPECT_FALSE(xr::rectangle_hit({{0, 0, 1}, {0, 0, 0}}, {}, {1, 1}));
}

}  // namespace
}  // namespace neuvv
