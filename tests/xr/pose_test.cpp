#include "xr/pose.h"

#include <gtest/gtest.h>

#include "tests/xr/some_poses.h"

namespace neuvv {
namespace {

using test::apart;
using test::SomePoses;

TEST(Pose, ComposesAsItsMatrixDoes) {
    SomePoses some(1);
    for (int i = 0; i < 100; ++i) {
        const Pose a = some.pose(), b = some.pose();
        EXPECT_LT(apart(matrix_of(a * b), matrix_of(a) * matrix_of(b)), 1e-12);
        EXPECT_LT(apart(matrix_of(inverse(a)), glm::inverse(matrix_of(a))), 1e-12);
        EXPECT_LT(apart(matrix_of(a * inverse(a)), glm::dmat4(1)), 1e-12);
        const glm::dvec3 point = some.vector(3);
        EXPECT_LT(glm::distance(a * point, glm::dvec3(matrix_of(a) * glm::dvec4(point, 1))), 1e-12);
    }
}

TEST(Pose, LooksAlongMinusZ) {
    SomePoses some(2);
    for (int i = 0; i < 20; ++i) {
        const Pose pose = some.pose();
        const glm::dvec3 z = matrix_of(pose)[2];
        EXPECT_LT(glm::distance(forward_of(pose), -z), 1e-12);
        EXPECT_LT(glm::distance(ray_of(pose).direction, -z), 1e-12);
        EXPECT_EQ(ray_of(pose).origin, pose.position);
    }
    EXPECT_EQ(forward_of({}), glm::dvec3(0, 0, -1));
}

TEST(Pose, ARuntimesFloatsAreNearEnough) {
    SomePoses some(3);
    Pose pose = some.pose();
    const glm::dmat4 exact = matrix_of(pose);
    pose.rotation *= 1.01;
    EXPECT_LT(apart(matrix_of(pose), exact), 1e-12) << "stays rigid";
    EXPECT_LT(apart(matrix_of(pose * inverse(pose)), glm::dmat4(1)), 1e-12);
}

TEST(Pose, YawIsWhereItLooks) {
    SomePoses some(4);
    for (int i = 0; i < 200; ++i) {
        const Pose pose = some.pose();
        const glm::dvec3 ahead = forward_of(pose);
        const double yaw = yaw_of(pose.rotation), across = std::hypot(ahead.x, ahead.z);
        EXPECT_NEAR(-std::sin(yaw) * across, ahead.x, 1e-12);
        EXPECT_NEAR(-std::cos(yaw) * across, ahead.z, 1e-12);
    }
    EXPECT_NEAR(yaw_of(turn_by(1.2)), 1.2, 1e-12);
    EXPECT_LT(forward_of({{}, turn_by(0.5)}).x, 0) << "to the left";
}

TEST(Pose, YawHoldsStraightUpAndDown) {
    for (const double yaw : {-2.5, -0.3, 0.0, 1.0, 3.0})
        for (const double pitch : {-90.0, -89.9999, -80.0, 0.0, 45.0, 89.9999, 90.0}) {
            const glm::dquat nodded = glm::angleAxis(glm::radians(pitch), glm::dvec3(1, 0, 0));
            EXPECT_NEAR(yaw_of(turn_by(yaw) * nodded), yaw, 1e-6) << pitch;
        }
}

TEST(Pose, TwistIsTheTurnAboutYWhateverTheTilt) {
    SomePoses some(5);
    for (int i = 0; i < 200; ++i) {
        const double yaw = some.number(-3, 3), tilt = some.number(-2.5, 2.5), way = some.number(-3, 3);
        const glm::dquat tilted = glm::angleAxis(tilt, glm::dvec3(std::cos(way), 0, std::sin(way)));
        EXPECT_NEAR(twist_of(turn_by(yaw) * tilted), yaw, 1e-12);
        EXPECT_NEAR(twist_of(tilted * turn_by(yaw)), yaw, 1e-12);
        EXPECT_NEAR(twist_of(-(turn_by(yaw) * tilted)), yaw, 1e-12) << "the same rotation";
        EXPECT_NEAR(tilt_cosine_of(turn_by(yaw) * tilted), std::cos(tilt / 2), 1e-12);
    }
}

TEST(Pose, IsSoundOrNot) {
    SomePoses some(6);
    for (int i = 0; i < 20; ++i) EXPECT_TRUE(is_sound(some.pose(1000)));
    for (const Pose& pose : test::no_poses()) EXPECT_FALSE(is_sound(pose));
}

}  // namespace
}  // namespace neuvv
