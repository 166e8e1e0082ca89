#include "xr/locomotion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "tests/xr/random_poses.h"

namespace neuvv {
namespace {

using test::kInfinite;
using test::kNan;
using test::max_difference;
using test::RandomPoses;

xr::XrRig random_rig(RandomPoses& random) {
    return {random.vector(5), random.number(-3, 3)};
}

glm::dvec3 head_world(const xr::XrRig& rig, const xr::Pose& head) {
    return (xr::world_from_tracking(rig) * head).position;
}

// The smallest angle between two headings.
double turned(double from_rad, double to_rad) {
    return std::abs(std::remainder(to_rad - from_rad, 2 * std::numbers::pi));
}

bool same(const xr::XrRig& a, const xr::XrRig& b) {
    return a.position == b.position && a.yaw_rad == b.yaw_rad;
}

TEST(Locomotion, TheRigIsAPose) {
    // A quarter turn to the left: what is ahead in the room is to the left in the world.
    const xr::Pose pose = xr::world_from_tracking({{1, 2, 3}, glm::radians(90.0)});
    EXPECT_LT(glm::distance(pose * glm::dvec3(0, 0, -1), {0, 2, 3}), 1e-12);
}

TEST(Locomotion, SnapTurnsLeaveTheHeadWhereItIs) {
    RandomPoses random(20);
    for (int i = 0; i < 100; ++i) {
        const xr::XrRig rig = random_rig(random);
        const xr::Pose head = random.pose();
        const double by = random.number(-4, 4);
        const xr::XrRig after = xr::turned_about_head(rig, head, by);
        EXPECT_LT(glm::distance(head_world(after, head), head_world(rig, head)), 1e-12);
        const glm::dquat looked = (xr::world_from_tracking(rig) * head).rotation,
                         looks = (xr::world_from_tracking(after) * head).rotation;
        EXPECT_LT(max_difference(glm::mat4_cast(looks), glm::mat4_cast(xr::turn_by(by) * looked)), 1e-12);
        EXPECT_NEAR(after.position.y, rig.position.y, 1e-12);
        EXPECT_LE(std::abs(after.yaw_rad), std::numbers::pi + 1e-12);
    }
}

TEST(Locomotion, EightTurnsAreNone) {
    RandomPoses random(21);
    const xr::XrRig rig = random_rig(random);
    const xr::Pose head = random.pose();
    xr::XrRig turning = rig;
    for (int i = 0; i < 8; ++i) turning = xr::turned_about_head(turning, head, glm::radians(45.0));
    EXPECT_LT(glm::distance(turning.position, rig.position), 1e-12);
    EXPECT_LT(turned(turning.yaw_rad, rig.yaw_rad), 1e-12);
}

TEST(Locomotion, TeleportsPutTheHeadThere) {
    RandomPoses random(22);
    for (int i = 0; i < 100; ++i) {
        const xr::XrRig rig = random_rig(random);
        const xr::Pose head = random.pose();
        const glm::dvec3 point = random.vector(10);
        const xr::XrRig moved = xr::with_head_above(rig, head, point);
        EXPECT_EQ(moved.yaw_rad, rig.yaw_rad);
        EXPECT_NEAR(moved.position.y, point.y, 1e-12);
        EXPECT_LT(glm::distance(head_world(moved, head), point + glm::dvec3(0, head.position.y, 0)), 1e-12);

        const double face = random.number(-3, 3);
        const xr::XrRig facing = xr::with_head_above(rig, head, point, face);
        EXPECT_LT(glm::distance(head_world(facing, head), point + glm::dvec3(0, head.position.y, 0)), 1e-12);
        EXPECT_NEAR(facing.position.y, point.y, 1e-12);
        EXPECT_LT(turned(xr::yaw_of((xr::world_from_tracking(facing) * head).rotation), face), 1e-9);
    }
}

TEST(Locomotion, BadInputMovesNothing) {
    RandomPoses random(23);
    const xr::XrRig rig = random_rig(random);
    const xr::Pose head = random.pose();
    for (const xr::Pose& pose : test::invalid_poses()) {
        EXPECT_TRUE(same(xr::turned_about_head(rig, pose, 1), rig));
        EXPECT_TRUE(same(xr::with_head_above(rig, pose, {1, 2, 3}, 1.0), rig));
        EXPECT_TRUE(same(xr::walked(rig, pose, {0, 1}, 1, 0.01), rig));
    }
    for (const double bad : {kNan, kInfinite, -kInfinite}) {
        EXPECT_TRUE(same(xr::turned_about_head(rig, head, bad), rig));
        EXPECT_TRUE(same(xr::with_head_above(rig, head, {1, 2, 3}, bad), rig));
        EXPECT_TRUE(same(xr::with_head_above(rig, head, {1, bad, 3}), rig));
        EXPECT_TRUE(same(xr::walked(rig, head, {0, bad}, 1, 0.01), rig));
        EXPECT_TRUE(same(xr::walked(rig, head, {bad, 1}, 1, 0.01), rig));
        EXPECT_TRUE(same(xr::walked(rig, head, {0, 1}, bad, 0.01), rig));
    }
    for (const double bad : {kNan, -kInfinite, -1.0, 0.0})
        EXPECT_TRUE(same(xr::walked(rig, head, {0, 1}, 1, bad), rig));
    for (const double bad : {kNan, 1.0, 2.0, -1.0}) EXPECT_TRUE(same(xr::walked(rig, head, {0, 1}, 1, 0.01, bad), rig));
}

xr::Pose thrown_from(glm::dvec3 at, double yaw_deg, double pitch_deg) {
    return {at, xr::turn_by(glm::radians(yaw_deg)) * glm::angleAxis(glm::radians(pitch_deg), glm::dvec3(1, 0, 0))};
}

double length_of(const xr::Arc& arc) {
    double length = 0;
    for (size_t i = 1; i < arc.points.size(); ++i) length += glm::distance(arc.points[i - 1], arc.points[i]);
    return length;
}

// The same throw, integrated in tiny steps: where it first meets the floor on its way down, unless its path is longer
// than `max_m` by then.
std::optional<glm::dvec3> integrated(const xr::Pose& aim, double floor_y, double speed, double max_m,
                                     double& length_m) {
    constexpr double kStep_s = 1e-5;
    glm::dvec3 at = aim.position, velocity = xr::forward_of(aim) * speed;
    for (length_m = 0; length_m < max_m;) {
        const glm::dvec3 before = at;
        at += velocity * kStep_s - glm::dvec3(0, 0.5 * 9.81 * kStep_s * kStep_s, 0);
        velocity.y -= 9.81 * kStep_s;
        length_m += glm::distance(before, at);
        if (before.y >= floor_y && at.y < floor_y) return at;
    }
    return {};
}

TEST(TeleportArc, LandsWhereAThrowDoes) {
    RandomPoses random(24);
    int landed = 0, lost = 0;
    for (int i = 0; i < 60; ++i) {
        const xr::Pose aim = thrown_from(random.vector(2), random.number(-180, 180), random.number(-90, 90));
        const double floor_y = random.number(-3, 1.5), speed = random.number(1, 9);
        const xr::Arc arc = xr::teleport_arc(aim, floor_y, speed);
        double length_m = 0;
        const auto truth = integrated(aim, floor_y, speed, 12, length_m);
        ASSERT_EQ(arc.landing.has_value(), truth.has_value()) << i;
        EXPECT_NEAR(length_of(arc), length_m, 0.05) << i << ": chords cut a steep throw's top";
        truth ? ++landed : ++lost;
        if (!truth) continue;
        EXPECT_LT(glm::distance(*arc.landing, *truth), 1e-3);
        EXPECT_EQ(arc.landing->y, floor_y);
        EXPECT_EQ(arc.points.back(), *arc.landing);
    }
    EXPECT_GT(landed, 15);
    EXPECT_GT(lost, 5);
}

TEST(TeleportArc, PointsAreOnTheParabolaAtEvenDistances) {
    for (const double pitch : {-90.0, -60.0, -10.0, 0.0, 30.0, 60.0, 75.0}) {
        const xr::Pose aim = thrown_from({1, 1.4, 2}, 40, pitch);
        const xr::Arc arc = xr::teleport_arc(aim, 0);
        ASSERT_TRUE(arc.landing);
        ASSERT_LE(arc.points.size(), xr::kMaxArcPoints);
        EXPECT_EQ(arc.points.front(), aim.position);
        const glm::dvec3 velocity = xr::forward_of(aim) * 6.0;
        for (size_t i = 1; i < arc.points.size(); ++i) {
            const double step = glm::distance(arc.points[i - 1], arc.points[i]);
            EXPECT_GT(step, 0.04) << pitch << " " << i;
            EXPECT_LT(step, 0.12) << pitch << " " << i;
            const glm::dvec3 from_start = arc.points[i] - aim.position;
            const double across = std::hypot(velocity.x, velocity.z);
            if (across < 1e-6) continue;
            const double t = std::hypot(from_start.x, from_start.z) / across;
            EXPECT_NEAR(from_start.y, velocity.y * t - 0.5 * 9.81 * t * t, 1e-6);
            EXPECT_NEAR(from_start.x, velocity.x * t, 1e-9);
        }
    }
}

TEST(TeleportArc, SteepThrowsTurnWhereTheyAreSlowest) {
    for (const double pitch : {80.0, 85.0, 88.0, 89.0, 89.9, 89.999, 90.0})
        for (const glm::dvec2 from : {glm::dvec2(1, 1), {1, 3}, {1, 6}, {0, 1}, {0, 3}, {0, 6}}) {  // height, speed
            const double height_m = from.x, speed = from.y;
            const xr::Arc arc = xr::teleport_arc(thrown_from({0, height_m, 0}, 0, pitch), 0, speed);
            ASSERT_TRUE(arc.landing);
            const double up = speed * std::sin(glm::radians(pitch)), length_m = height_m + up * up / 9.81;
            EXPECT_GT(length_of(arc), length_m - 0.09) << pitch << " " << speed;
            const auto highest = std::max_element(arc.points.begin(), arc.points.end(),
                                                  [](glm::dvec3 a, glm::dvec3 b) { return a.y < b.y; });
            EXPECT_TRUE(
                std::is_sorted(arc.points.begin(), highest + 1, [](glm::dvec3 a, glm::dvec3 b) { return a.y < b.y; }));
            EXPECT_TRUE(
                std::is_sorted(highest, arc.points.end(), [](glm::dvec3 a, glm::dvec3 b) { return a.y > b.y; }));
            for (size_t i = 1; i < arc.points.size(); ++i)
                EXPECT_LT(glm::distance(arc.points[i - 1], arc.points[i]), xr::kArcSpacing_m + 1e-5)
                    << pitch << " " << i;
        }
}

TEST(TeleportArc, EndsWhereItIsTooFar) {
    const xr::Pose up = thrown_from({0, 1, 0}, 0, 60);
    const xr::Arc far = xr::teleport_arc(up, 0, 50, 12);
    EXPECT_FALSE(far.landing);
    EXPECT_NEAR(length_of(far), 12, 0.01);
    EXPECT_LE(far.points.size(), xr::kMaxArcPoints);
    const xr::Arc farther = xr::teleport_arc(up, 0, 50, 1000);
    EXPECT_TRUE(farther.landing);
    EXPECT_EQ(farther.points.size(), xr::kMaxArcPoints);
    const xr::Arc below = xr::teleport_arc(thrown_from({0, -1, 0}, 0, 10), 0);
    EXPECT_FALSE(below.landing) << "the floor is above";
    EXPECT_NEAR(length_of(below), 12, 0.01);
    const xr::Arc through = xr::teleport_arc(thrown_from({0, -1, 0}, 0, 80), 0);
    ASSERT_TRUE(through.landing);
    const auto highest = std::max_element(through.points.begin(), through.points.end(),
                                          [](glm::dvec3 a, glm::dvec3 b) { return a.y < b.y; });
    EXPECT_GT(highest->y, 0.5) << "rises through it first";
}

TEST(TeleportArc, DegenerateThrows) {
    const xr::Arc dropped = xr::teleport_arc(thrown_from({0, 1, 0}, 0, 0), 0, 0);
    ASSERT_TRUE(dropped.landing);
    EXPECT_LT(glm::distance(*dropped.landing, {0, 0, 0}), 1e-12);
    EXPECT_NEAR(length_of(dropped), 1, 1e-9);
    const xr::Arc straight_up = xr::teleport_arc(thrown_from({0, 1, 0}, 0, 90), 0);
    ASSERT_TRUE(straight_up.landing);
    EXPECT_LT(glm::distance(*straight_up.landing, {0, 0, 0}), 1e-6);
    const xr::Arc on_it = xr::teleport_arc(thrown_from({1, 0, 2}, 0, -20), 0);
    ASSERT_TRUE(on_it.landing);
    EXPECT_LT(glm::distance(*on_it.landing, {1, 0, 2}), 1e-12);
    for (const xr::Arc& arc : {dropped, straight_up, on_it, xr::teleport_arc({}, -1e9, 1e6, 1e6)})
        for (const glm::dvec3 point : arc.points) EXPECT_TRUE(std::isfinite(point.x + point.y + point.z));
    for (const xr::Pose& pose : test::invalid_poses()) EXPECT_TRUE(xr::teleport_arc(pose, 0).points.empty());
    for (const double bad : {kNan, kInfinite, -kInfinite}) {
        for (const xr::Arc& arc :
             {xr::teleport_arc({}, bad), xr::teleport_arc({}, -1, bad), xr::teleport_arc({}, -1, 6, bad)}) {
            EXPECT_TRUE(arc.points.empty());
            EXPECT_FALSE(arc.landing);
        }
    }
    EXPECT_TRUE(xr::teleport_arc({}, -1, -1).points.empty());
    EXPECT_TRUE(xr::teleport_arc({}, -1, 6, 0).points.empty());
}

TEST(Walking, GoesWhereTheHeadLooks) {
    RandomPoses random(25);
    for (int i = 0; i < 100; ++i) {
        const xr::XrRig rig = random_rig(random);
        const xr::Pose head = random.pose();
        glm::dvec3 ahead = xr::forward_of(xr::world_from_tracking(rig) * head);
        ahead.y = 0;
        ahead = glm::normalize(ahead);
        const glm::dvec3 right = glm::cross(ahead, glm::dvec3(0, 1, 0));
        const xr::XrRig forwards = xr::walked(rig, head, {0, 1}, 2, 0.05),
                        sideways = xr::walked(rig, head, {1, 0}, 2, 0.05);
        EXPECT_LT(glm::distance(forwards.position - rig.position, ahead * 0.1), 1e-9);
        EXPECT_LT(glm::distance(sideways.position - rig.position, right * 0.1), 1e-9);
        EXPECT_EQ(forwards.yaw_rad, rig.yaw_rad);
    }
}

double walked_m(glm::dvec2 stick, double dt_s = 0.05) {
    return glm::length(xr::walked({}, {}, stick, 2, dt_s).position);
}

TEST(Walking, TheDeadZoneIsRoundAndItsEdgeNoStep) {
    for (double angle = 0; angle < 6.3; angle += 0.3) {
        const glm::dvec2 direction(std::cos(angle), std::sin(angle));
        EXPECT_EQ(walked_m(direction * 0.149), 0);
        EXPECT_GT(walked_m(direction * 0.151), 0);
        EXPECT_LT(walked_m(direction * 0.151), 0.1 * 0.01) << "begins slowly";
        EXPECT_NEAR(walked_m(direction * 0.575), 0.05, 1e-12) << "half way";
        EXPECT_NEAR(walked_m(direction), 0.1, 1e-12);
        EXPECT_NEAR(walked_m(direction * 1.4), 0.1, 1e-12) << "a square stick's corner";
    }
    EXPECT_EQ(walked_m({0, 0}), 0);
    EXPECT_EQ(glm::length(xr::walked({}, {}, {0, 0}, 2, 0.05, 0).position), 0);
}

TEST(Walking, ALateFrameIsNoLeap) {
    EXPECT_NEAR(walked_m({0, 1}, 0.1), 0.2, 1e-12);
    EXPECT_NEAR(walked_m({0, 1}, 7), 0.2, 1e-12);
    EXPECT_NEAR(walked_m({0, 1}, kInfinite), 0.2, 1e-12);
}

TEST(Vignette, GrowsSmoothlyToOne) {
    EXPECT_EQ(xr::vignette_of(0, 0), 0);
    EXPECT_EQ(xr::vignette_of(xr::kVignetteSpeed_m_per_s, 0), 1);
    EXPECT_EQ(xr::vignette_of(0, xr::kVignetteTurn_rad_per_s), 1);
    EXPECT_EQ(xr::vignette_of(kInfinite, 0), 1);
    EXPECT_EQ(xr::vignette_of(kNan, kNan), 0);
    EXPECT_EQ(xr::vignette_of(kNan, kInfinite), 1);
    EXPECT_EQ(xr::vignette_of(-1, -0.5), xr::vignette_of(1, 0.5));
    constexpr double kStep = 0.01;
    for (double speed = 0; speed < 4; speed += kStep)
        for (const double turn : {0.0, 0.4, 1.0, 2.0}) {
            const double here = xr::vignette_of(speed, turn);
            EXPECT_GE(here, 0);
            EXPECT_LE(here, 1);
            EXPECT_GE(xr::vignette_of(speed + kStep, turn), here);
            EXPECT_GE(xr::vignette_of(speed, turn + kStep), here);
            EXPECT_LT(xr::vignette_of(speed + kStep, turn) - here, 0.01) << "smooth";
        }
    EXPECT_GT(xr::vignette_of(1.5, 0), 0.2);
    EXPECT_GT(xr::vignette_of(1.5, 0.4), xr::vignette_of(1.5, 0));
}

}  // namespace
}  // namespace neuvv
