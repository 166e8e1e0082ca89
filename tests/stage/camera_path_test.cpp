// Tests that a camera path goes through its keys without jumps, overshoot, flips or a tilting horizon.
#include "stage/camera_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace neuvv {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// A camera turned about +Y, then up about its own x, then by `roll` about its axis of view.
glm::dquat facing(double yaw_deg, double pitch_deg, double roll_deg = 0) {
    return glm::angleAxis(yaw_deg * kDegree, glm::dvec3(0, 1, 0)) *
           glm::angleAxis(pitch_deg * kDegree, glm::dvec3(1, 0, 0)) *
           glm::angleAxis(roll_deg * kDegree, glm::dvec3(0, 0, 1));
}

stage::CameraPathKey key_at(double time_s, glm::dvec3 position, glm::dquat turn = {1, 0, 0, 0}, double angle_y = 0.7) {
    stage::CameraPathKey key;
    key.time_s = time_s;
    key.position = position;
    key.world_from_camera = turn;
    key.angle_y = angle_y;
    return key;
}

stage::CameraPath path_of(std::vector<stage::CameraPathKey> keys,
                          stage::Interpolation interpolation = stage::Interpolation::kSmooth) {
    stage::CameraPath path;
    path.duration_s = keys.back().time_s;
    path.keys = std::move(keys);
    path.interpolation = interpolation;
    return path;
}

glm::dvec3 position_at(const stage::CameraPath& path, double t) {
    return glm::dvec3(stage::camera_at(path, t, 64, 48).world_from_camera[3]);
}
glm::dquat turn(const stage::CameraPath& path, double t) {
    return glm::quat_cast(glm::dmat3(stage::camera_at(path, t, 64, 48).world_from_camera));
}
double angle(const stage::CameraPath& path, double t) {
    const stage::Camera camera = stage::camera_at(path, t, 64, 48);
    return 2 * std::atan(0.5 * camera.height / camera.fy);
}
// The angle between two orientations, 0 to π.
double turned_by(const glm::dquat& a, const glm::dquat& b) {
    const glm::dquat d = glm::conjugate(a) * b;
    return 2 * std::atan2(glm::length(glm::dvec3(d.x, d.y, d.z)), std::abs(d.w));
}

// A path with uneven times, turns in all directions and a zoom.
stage::CameraPath wild_path() {
    return path_of({key_at(0, {0, 1, 4}, facing(0, -5), 0.7), key_at(0.5, {2, 1.5, 3}, facing(40, -20, 15), 0.5),
                    key_at(2, {4, 1, 0}, facing(130, 10, -30), 0.9), key_at(2.25, {3, 3, -2}, facing(200, -40, 5), 0.9),
                    key_at(5, {-4, 2, -3}, facing(300, 0), 0.4)});
}

// The angular velocity about the camera's axes, from a difference over a short time.
glm::dvec3 spin(const stage::CameraPath& path, double from, double to) {
    glm::dquat d = glm::conjugate(turn(path, from)) * turn(path, to);
    if (d.w < 0) d = -d;
    return 2.0 * glm::dvec3(d.x, d.y, d.z) / (to - from);
}

TEST(CameraPath, GoesThroughItsKeys) {
    for (const stage::Interpolation interpolation :
         {stage::Interpolation::kSmooth, stage::Interpolation::kLinear, stage::Interpolation::kCut})
        for (const bool cyclic : {false, true}) {
            stage::CameraPath path = wild_path();
            path.interpolation = interpolation;
            path.cyclic = cyclic;
            if (cyclic) path.duration_s = 6.5;
            for (const stage::CameraPathKey& key : path.keys) {
                EXPECT_EQ(position_at(path, key.time_s), key.position);
                EXPECT_LT(turned_by(turn(path, key.time_s), key.world_from_camera), 1e-12);
                EXPECT_NEAR(angle(path, key.time_s), key.angle_y, 1e-12);
                if (interpolation == stage::Interpolation::kCut || key.time_s == 0) continue;
                const double before = key.time_s - 1e-9;  // there is no jump before the key
                EXPECT_LT(glm::distance(position_at(path, before), key.position), 1e-7);
                EXPECT_LT(turned_by(turn(path, before), key.world_from_camera), 1e-7);
            }
        }
}

// One-sided differences on both sides of each key agree as h goes to 0: the velocity has no jump. A linear path has
// such jumps, which the test must detect.
TEST(CameraPath, VelocityHasNoJumpAtKeys) {
    constexpr double h = 1e-5;
    stage::CameraPath path = wild_path();
    path.cyclic = true;
    path.duration_s = 6.5;
    const auto jump_at = [&](double t) {
        const double jumps = glm::length((position_at(path, t + h) - position_at(path, t)) -
                                         (position_at(path, t) - position_at(path, t - h)));
        const double turns = glm::length(spin(path, t, t + h) - spin(path, t - h, t));
        const double angles = std::abs(angle(path, t + h) - 2 * angle(path, t) + angle(path, t - h));
        return glm::dvec3(jumps / h, turns, angles / h);
    };
    for (const stage::CameraPathKey& key : path.keys)
        for (int i = 0; i < 3; ++i) EXPECT_LT(jump_at(key.time_s)[i], 2e-3) << key.time_s << ", " << i;
    path.interpolation = stage::Interpolation::kLinear;
    for (int i = 0; i < 2; ++i) EXPECT_GT(jump_at(2)[i], 0.1);
}

TEST(CameraPath, EvenKeysOnALineGiveConstantSpeed) {
    std::vector<stage::CameraPathKey> keys;
    for (int i = 0; i < 5; ++i)
        keys.push_back(key_at(0.5 * i, {1.0 * i, 2.0 * i, -1.0 * i}, facing(20.0 * i, 0), 0.5 + 0.1 * i));
    const stage::CameraPath path = path_of(keys);
    for (int i = 0; i <= 40; ++i) {
        const double t = 0.05 * i;
        EXPECT_LT(glm::distance(position_at(path, t), glm::dvec3(2 * t, 4 * t, -2 * t)), 1e-12);
        EXPECT_LT(turned_by(turn(path, t), facing(40 * t, 0)), 1e-7);
        EXPECT_NEAR(angle(path, t), 0.5 + 0.2 * t, 1e-12);
    }
}

// Steps of very different lengths in very different times: Catmull–Rom without the limit of velocity overshoots here.
TEST(CameraPath, AMonotonePathIsNeverOvershot) {
    const double xs[] = {0, 0.01, 5, 5.02, 5.02, 9, 9.5}, ts[] = {0, 1, 1.1, 3, 4, 4.1, 9};
    std::vector<stage::CameraPathKey> keys;
    for (size_t i = 0; i < std::size(xs); ++i)
        keys.push_back(key_at(ts[i], {xs[i], 0, 0}, {1, 0, 0, 0}, 0.1 * xs[i] + 0.1));
    const stage::CameraPath path = path_of(keys);
    double x = 0, a = 0;
    for (int i = 0; i <= 9000; ++i) {
        const double t = i / 1000.0;
        EXPECT_GE(position_at(path, t).x, x - 1e-12) << t;
        EXPECT_GE(angle(path, t), a - 1e-12) << t;
        x = position_at(path, t).x;
        a = angle(path, t);
        EXPECT_TRUE(t < 3 || t > 4 || x == 5.02) << "it holds between equal keys";
    }
    EXPECT_EQ(x, 9.5);
}

TEST(CameraPath, AnglesOfViewStopAtTheirExtrema) {
    const stage::CameraPath path = path_of({key_at(0, {}, {1, 0, 0, 0}, 0.4), key_at(1, {}, {1, 0, 0, 0}, 1.0),
                                            key_at(1.2, {}, {1, 0, 0, 0}, 0.3), key_at(3, {}, {1, 0, 0, 0}, 0.5)});
    for (int i = 0; i <= 300; ++i) {
        EXPECT_LE(angle(path, i / 100.0), 1 + 1e-12);
        EXPECT_GE(angle(path, i / 100.0), 0.3 - 1e-12);
    }
}

TEST(CameraPath, TurnsTheShorterWayWhateverTheSign) {
    // 350° is 10° to the left; both signs of a quaternion are one orientation.
    for (const stage::Interpolation interpolation : {stage::Interpolation::kSmooth, stage::Interpolation::kLinear}) {
        const stage::CameraPath path =
            path_of({key_at(0, {}, facing(0, 0)), key_at(1, {}, -facing(350, 0)), key_at(2, {}, facing(340, 0))},
                    interpolation);
        for (int i = 0; i <= 200; ++i) EXPECT_LT(turned_by(turn(path, i / 100.0), facing(-0.1 * i, 0)), 1e-7) << i;
    }
    // The wild path jumps at no time: it turns by less than 2° in 1 ms, although it turns 90° in 250 ms.
    stage::CameraPath path = wild_path();
    path.cyclic = true;
    path.duration_s = 6.5;
    for (int i = 0; i < 6500; ++i)
        EXPECT_LT(turned_by(turn(path, i / 1000.0), turn(path, (i + 1) / 1000.0)), 2 * kDegree) << i;
}

// Between level keys the path stays level up to rounding. At 20° down and 90° from key to key, the great circle of
// orientations would tilt the horizon by several degrees, which the test must detect.
TEST(CameraPath, TheHorizonStaysLevel) {
    std::vector<stage::CameraPathKey> keys;
    for (int i = 0; i < 4; ++i) keys.push_back(key_at(i, {}, facing(90.0 * i, i % 2 ? -40 : -20)));
    stage::CameraPath path = path_of(keys);
    path.cyclic = true;
    path.duration_s = 4;
    double great_circle = 0;
    for (const stage::Interpolation interpolation : {stage::Interpolation::kSmooth, stage::Interpolation::kLinear}) {
        path.interpolation = interpolation;
        for (int i = 0; i < 400; ++i) {
            EXPECT_NEAR(stage::roll_of(turn(path, i / 100.0)), 0, 1e-9) << i;
            const size_t k = static_cast<size_t>(i / 100);
            great_circle = std::max(
                great_circle, std::abs(stage::roll_of(glm::slerp(
                                  keys[k].world_from_camera, keys[(k + 1) % 4].world_from_camera, i % 100 / 100.0))));
        }
    }
    EXPECT_GT(great_circle, 2 * kDegree);
}

TEST(CameraPath, RollFollowsItsKeysAndMeansNothingNearTheVertical) {
    const stage::CameraPath path = path_of({key_at(0, {}, facing(0, -10, 0)), key_at(1, {}, facing(60, -20, 30))});
    for (int i = 0; i <= 10; ++i) EXPECT_NEAR(stage::roll_of(turn(path, 0.1 * i)), 3 * kDegree * i, 1e-9);
    // The view goes up, over the pole and on, without a flip.
    const stage::CameraPath over = path_of({key_at(0, {}, facing(0, 60)), key_at(1, {}, facing(0, 120))});
    for (int i = 0; i <= 100; ++i)
        EXPECT_LT(turned_by(turn(over, i / 100.0), turn(over, (i + 1) / 100.0)), 3 * kDegree);
    EXPECT_TRUE(std::isfinite(stage::roll_of(facing(0, 90))));
}

TEST(CameraPath, ACycleJoins) {
    std::vector<stage::CameraPathKey> keys;  // a circle, keyed unevenly
    for (const double degrees : {0.0, 50.0, 110.0, 150.0, 210.0, 250.0, 310.0})
        keys.push_back(
            key_at(degrees / 90, {std::sin(degrees * kDegree), 0, std::cos(degrees * kDegree)}, facing(degrees, 0)));
    stage::CameraPath path = path_of(keys);
    path.cyclic = true;
    path.duration_s = 4;
    for (int i = 0; i < 400; ++i) {
        const double t = i / 100.0;
        EXPECT_LT(glm::distance(position_at(path, t), position_at(path, t + 4)), 1e-12);
        EXPECT_LT(glm::distance(position_at(path, t), position_at(path, t - 4)), 1e-12);
        // Cubic curves are not circles; chords would be 0.13 off.
        EXPECT_NEAR(glm::length(position_at(path, t)), 1, 0.05);
        EXPECT_LT(turned_by(turn(path, t), facing(90 * t, 0)), 1e-7) << "a steady turn stays one across the join";
    }
}

TEST(CameraPath, AnOpenPathRestsAtItsEnds) {
    stage::CameraPath path = wild_path();
    path.duration_s = 9;
    EXPECT_EQ(position_at(path, -1), path.keys[0].position);
    EXPECT_EQ(position_at(path, 9), path.keys.back().position);
    EXPECT_EQ(position_at(path_of({key_at(0, {1, 2, 3})}), 5), glm::dvec3(1, 2, 3));
}

TEST(CameraPath, ACutHoldsUntilTheNextKey) {
    stage::CameraPath path = wild_path();
    path.interpolation = stage::Interpolation::kCut;
    EXPECT_EQ(position_at(path, 1.999), path.keys[1].position);
    EXPECT_EQ(position_at(path, 2), path.keys[2].position);
}

TEST(CameraPath, CamerasHaveTheLensOfTheirKeysInAnyImage) {
    stage::CameraPathKey key = key_at(0, {});
    key.angle_y = 2 * std::atan(0.5);
    key.stretch = 1.25;
    key.shift = {0.1, -0.2};
    const stage::Camera camera = stage::camera_at(path_of({key}), 0, 200, 100);
    EXPECT_NEAR(camera.fy, 100, 1e-9);
    EXPECT_NEAR(camera.fx, 125, 1e-9);
    EXPECT_NEAR(camera.cx, 110, 1e-9);
    EXPECT_NEAR(camera.cy, 30, 1e-9);
    EXPECT_EQ(camera.width, 200u);
    key.angle_x = 2 * std::atan(0.5);  // now the horizontal angle counts
    EXPECT_NEAR(stage::camera_at(path_of({key}), 0, 200, 100).fx, 200, 1e-9);
}

TEST(CameraPath, ClipTimesComeFromKeysThatHaveThem) {
    std::vector<stage::CameraPathKey> keys;
    for (int i = 0; i < 4; ++i) keys.push_back(key_at(i, {}));
    keys[0].clip_time = 0.25;
    keys[1].clip_time = 0.5;
    keys[2].clip_time = 1;
    const stage::CameraPath path = path_of(keys);
    EXPECT_EQ(stage::clip_time_at(path, 0), 0.25);
    EXPECT_EQ(stage::clip_time_at(path, 1), 0.5);
    EXPECT_EQ(stage::clip_time_at(path, 2), 1);
    EXPECT_FALSE(stage::clip_time_at(path, 2.5));
    EXPECT_FALSE(stage::clip_time_at(path, 3));
    double last = 0;
    for (int i = 0; i <= 200; ++i) {
        const double time = stage::clip_time_at(path, i / 100.0).value();
        EXPECT_GE(time, last);
        EXPECT_LE(time, 1);
        last = time;
    }
}

}  // namespace
}  // namespace neuvv
