#include "xr/hand_tracking.h"

#include <gtest/gtest.h>

#include "xr/random_poses.h"

namespace neuvv::test {
namespace {

// A flat hand whose fingers point along `ahead`, with the tips of thumb and index finger `apart_m` apart.
xr::HandJoints hand_at(glm::dvec3 wrist, glm::dvec3 ahead, double apart_m) {
    xr::HandJoints joints(XR_HAND_JOINT_COUNT_EXT, {wrist});
    joints[XR_HAND_JOINT_INDEX_PROXIMAL_EXT].position = wrist + 0.09 * ahead;
    joints[XR_HAND_JOINT_INDEX_TIP_EXT].position = wrist + 0.18 * ahead;
    joints[XR_HAND_JOINT_THUMB_TIP_EXT].position = wrist + 0.18 * ahead + glm::dvec3(0, apart_m, 0);
    return joints;
}

TEST(HandTracking, APinchGoesFromFiveCentimetresToATouch) {
    const glm::dvec3 wrist(0.2, 1, -0.3), ahead(0, 0, -1);
    EXPECT_EQ(xr::pinch_of(hand_at(wrist, ahead, 0.2)), 0);
    EXPECT_NEAR(xr::pinch_of(hand_at(wrist, ahead, 0.05)), 0, 1e-9);
    EXPECT_EQ(xr::pinch_of(hand_at(wrist, ahead, 0.005)), 1);
    double last = -1;
    for (const double apart_m : {0.049, 0.04, 0.03, 0.02, 0.016}) {
        const double pinch = xr::pinch_of(hand_at(wrist, ahead, apart_m));
        EXPECT_GT(pinch, last) << apart_m;
        EXPECT_LT(pinch, 1) << apart_m;
        last = pinch;
    }
    EXPECT_EQ(xr::pinch_of({}), 0) << "a hand that is not seen";
}

TEST(HandTracking, ABareHandPointsAlongItsIndexFinger) {
    RandomPoses random(3);
    for (int i = 0; i < 50; ++i) {
        const glm::dvec3 wrist = random.vector(1), ahead = glm::normalize(random.vector(1));
        xr::HandInput input;
        ASSERT_TRUE(xr::fill_from_joints(input, hand_at(wrist, ahead, 0.01)));
        ASSERT_TRUE(input.aim);
        EXPECT_LT(glm::distance(input.aim->position, wrist + 0.09 * ahead), 1e-9) << i;
        EXPECT_LT(glm::distance(input.aim->rotation * glm::dvec3(0, 0, -1), ahead), 1e-6) << i;
        EXPECT_EQ(input.select, 1);
        EXPECT_TRUE(input.bare_hand);
        EXPECT_FALSE(input.has_grab);
        EXPECT_TRUE(input.lacks_menu);
    }
}

TEST(HandTracking, AHandWithAControllerKeepsIt) {
    xr::HandInput input;
    input.aim = xr::Pose{{1, 2, 3}, {1, 0, 0, 0}};
    input.select = 0.3;
    EXPECT_FALSE(xr::fill_from_joints(input, hand_at({}, {0, 0, -1}, 0)));
    EXPECT_EQ(input.aim->position, glm::dvec3(1, 2, 3));
    EXPECT_EQ(input.select, 0.3);
}

TEST(HandTracking, AFistThatTheRuntimeKnowsGoesOnHolding) {
    xr::HandInput input;
    input.bare_hand = true;  // by XR_EXT_hand_interaction, without an aim pose in this frame
    input.grab = 1;
    EXPECT_FALSE(xr::fill_from_joints(input, hand_at({}, {0, 0, -1}, 0)));
    EXPECT_TRUE(input.has_grab);
    EXPECT_EQ(input.select, 0);
}

TEST(HandTracking, WhatIsNoHandStandsInForNone) {
    xr::HandInput input;
    EXPECT_FALSE(xr::fill_from_joints(input, {}));
    EXPECT_FALSE(xr::fill_from_joints(input, xr::HandJoints(3)));
    EXPECT_FALSE(xr::fill_from_joints(input, xr::HandJoints(XR_HAND_JOINT_COUNT_EXT)))
        << "all joints in one place point nowhere";
    EXPECT_FALSE(input.aim);
}

}  // namespace
}  // namespace neuvv::test
