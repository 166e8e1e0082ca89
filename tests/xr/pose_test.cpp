#include "xr/pose.h"

#include <gtest/gtest.h>

#include "tests/xr/random_poses.h"

namespace neuvv {
namespace {

using test::max_difference;
using test::RandomPoses;

TEST(Pose, ComposesAsItsMatrixDoes) {
    RandomPoses random(1);
    for (int i = 0; i < 100; ++i) {
        const xr::Pose a = random.pose(), b = random.pose();
        EXPECT_LT(max_difference(xr::matrix_of(a * b), xr::matrix_of(a) * xr::matrix_of(b)), 1e-12);
        EXPECT_LT(max_difference(xr::matrix_of(xr::inverse(a)), glm::inverse(xr::matrix_of(a))), 1e-12);
        EXPECT_LT(max_difference(xr::matrix_of(a * xr::inverse(a)), glm::dmat4(1)), 1e-12);
        const glm::dvec3 point = random.vector(3);
        EXPECT_LT(glm::distance(a * point, glm::dvec3(xr::matrix_of(a) * glm::dvec4(point, 1))), 1e-12);
    }
}

TEST(Pose, LooksAlongMinusZ) {
    RandomPoses random(2);
    for (int i = 0; i < 20; ++i) {
        const xr::Pose pose = random.pose();
        const glm::dvec3 z = xr::matrix_of(pose)[2];
        EXPECT_LT(glm::distance(xr::forward_of(pose), -z), 1e-12);
        EXPECT_LT(glm::distance(xr::ray_of(pose).direction, -z), 1e-12);
        EXPECT_EQ(xr::ray_of(pose).origin, pose.position);
    }
    EXPECT_EQ(xr::forward_of({}), glm::dvec3(0, 0, -1));
}

TEST(Pose, ARuntimesFloatsAreNearEnough) {
    RandomPoses random(3);
    xr::Pose pose = random.pose();
    const glm::dmat4 exact = xr::matrix_of(pose);
    pose.rotation *= 1.01;
    EXPECT_LT(max_difference(xr::matrix_of(pose), exact), 1e-12) << "stays rigid";
    EXPECT_LT(max_difference(xr::matrix_of(pose * xr::inverse(pose)), glm::dmat4(1)), 1e-12);
}

TEST(Pose, YawIsWhereItLooks) {
    RandomPoses random(4);
    for (int i = 0; i < 200; ++i) {
        const xr::Pose pose = random.pose();
        const glm::dvec3 ahead = xr::forward_of(pose);
        const double yaw = xr::yaw_of(pose.rotation), across = std::hypot(ahead.x, ahead.z);
        EXPECT_NEAR(-std::sin(yaw) * across, ahead.x, 1e-12);
        EXPECT_NEAR(-std::cos(yaw) * across, ahead.z, 1e-12);
    }
    EXPECT_NEAR(xr::yaw_of(xr::turn_by(1.2)), 1.2, 1e-12);
    EXPECT_LT(xr::forward_of({{}, xr::turn_by(0.5)}).x, 0) << "to the left";
}

TEST(Pose, YawHoldsStraightUpAndDown) {
    for (const double yaw : {-2.5, -0.3, 0.0, 1.0, 3.0})
        for (const double pitch : {-90.0, -89.9999, -80.0, 0.0, 45.0, 89.9999, 90.0}) {
            const glm::dquat nodded = glm::angleAxis(glm::radians(pitch), glm::dvec3(1, 0, 0));
            EXPECT_NEAR(xr::yaw_of(xr::turn_by(yaw) * nodded), yaw, 1e-6) << pitch;
        }
}

TEST(Pose, TwistIsTheTurnAboutYWhateverTheTilt) {
    RandomPoses random(5);
    for (int i = 0; i < 200; ++i) {
        const double yaw = random.number(-3, 3), tilt = random.number(-2.5, 2.5), heading = random.number(-3, 3);
        const glm::dquat tilted = glm::angleAxis(tilt, glm::dvec3(std::cos(heading), 0, std::sin(heading)));
        EXPECT_NEAR(xr::twist_of(xr::turn_by(yaw) * tilted), yaw, 1e-12);
        EXPECT_NEAR(xr::twist_of(tilted * xr::turn_by(yaw)), yaw, 1e-12);
        EXPECT_NEAR(xr::twist_of(-(xr::turn_by(yaw) * tilted)), yaw, 1e-12) << "the same rotation";
        EXPECT_NEAR(xr::tilt_cosine_of(xr::turn_by(yaw) * tilted), std::cos(tilt / 2), 1e-12);
    }
}

TEST(Pose, IsSoundOrNot) {
    RandomPoses random(6);
    for (int i = 0; i < 20; ++i) EXPECT_TRUE(xr::is_valid(random.pose(1000)));
    for (const xr::Pose& pose : test::invalid_poses()) EXPECT_FALSE(xr::is_valid(pose));
}

}  // namespace
}  // namespace neuvv
