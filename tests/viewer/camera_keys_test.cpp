#include "tools/viewer/timeline/camera_keys.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/near.h"

namespace neuvv {
namespace {

using test::expect_near;

stage::CameraPath path_at(std::initializer_list<double> times_s) {
    stage::CameraPath path;
    for (const double time_s : times_s) {
        stage::CameraPathKey key;
        key.time_s = path.duration_s = time_s;
        key.position = {time_s, 1, 2};
        path.keys.push_back(key);
    }
    return path;
}

// The view with which a key was set is that of the path at the time of the key.
TEST(CameraKeys, AViewComesBackFromItsKey) {
    viewer::Eye eye;
    eye.pivot = {0.3, 1.1, -0.4};
    eye.yaw = 2.2;
    eye.pitch = -0.7;
    eye.distance = 2.5;
    eye.angle_y = 0.8;
    for (const double roll : {0.0, 0.4}) {
        eye.roll = roll;
        stage::CameraPath path;
        path.keys = {viewer::key_of(eye, 1)};
        path.duration_s = 1;
        const viewer::Eye back = viewer::eye_on(path, 1, eye.distance);
        expect_near(viewer::world_from_eye(back), viewer::world_from_eye(eye));
        EXPECT_NEAR(back.angle_y, eye.angle_y, 1e-12);
        EXPECT_NEAR(glm::distance(back.pivot, eye.pivot), 0, 1e-9);
    }
}

TEST(CameraKeys, TheNearestInTimeIsFound) {
    const stage::CameraPath path = path_at({0, 1, 4});
    EXPECT_EQ(viewer::nearest_key(path, -3), 0u);
    EXPECT_EQ(viewer::nearest_key(path, 0.6), 1u);
    EXPECT_EQ(viewer::nearest_key(path, 2.4), 1u);
    EXPECT_EQ(viewer::nearest_key(path, 100), 2u);
}

TEST(CameraKeys, ACycleTakesTimeToComeBack) {
    const stage::CameraPath cycle = viewer::with_cyclic(path_at({0, 1, 4}), true);
    EXPECT_TRUE(cycle.cyclic);
    EXPECT_EQ(cycle.duration_s, 6) << "two seconds from key to key";
    const stage::CameraPath open = viewer::with_cyclic(cycle, false);
    EXPECT_FALSE(open.cyclic);
    EXPECT_EQ(open.duration_s, 4);
    EXPECT_EQ(viewer::with_cyclic(path_at({2}), true).duration_s, 3);
    stage::CameraPath longer = path_at({0, 1});
    longer.duration_s = 5;
    EXPECT_EQ(viewer::with_cyclic(longer, true).duration_s, 5) << "there is time already";
}

TEST(CameraKeys, TheLineGoesThroughAllKeysAndHome) {
    stage::CameraPath path = path_at({0, 1, 4});
    const std::vector<glm::dvec3> line = viewer::line_of(path, 8);
    ASSERT_EQ(line.size(), 17u);
    for (const size_t key : {0u, 1u, 2u}) EXPECT_NEAR(glm::distance(line[8 * key], path.keys[key].position), 0, 1e-9);
    const std::vector<glm::dvec3> round = viewer::line_of(viewer::with_cyclic(path, true), 8);
    ASSERT_EQ(round.size(), 25u);
    EXPECT_NEAR(glm::distance(round[16], path.keys[2].position), 0, 1e-9);
    EXPECT_NEAR(glm::distance(round[24], path.keys[0].position), 0, 1e-9);
    EXPECT_NEAR(glm::distance(round[23], round[24]), glm::distance(round[1], round[0]), 0.5) << "no jump home";
    path.interpolation = stage::Interpolation::kCut;
    EXPECT_TRUE(viewer::line_of(path, 8).empty());
    stage::CameraPath many;
    for (int i = 0; i < 3000; ++i) {
        many.keys.push_back({});
        many.keys.back().time_s = many.duration_s = i;
    }
    EXPECT_LE(viewer::line_of(many, 24).size(), viewer::kMaxLinePoints);
}

}  // namespace
}  // namespace neuvv
