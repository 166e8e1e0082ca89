#include "xr/body_points.h"

#include <gtest/gtest.h>

#include <cmath>

#include "xr/body_joints.h"

namespace neuvv::test {
namespace {

using motion::Joint;

constexpr xr::Pose kHead{{0, 1.6, 0}, {1, 0, 0, 0}};

size_t count_measured(const motion::Pose& pose) {
    return static_cast<size_t>(
        std::count_if(pose.begin(), pose.end(), [](const auto& joint) { return joint.measured; }));
}

void expect_at(const motion::Pose& pose, Joint joint, glm::dvec3 position, double confidence, bool measured) {
    const motion::JointSample& found = motion::at(pose, joint);
    EXPECT_LT(glm::distance(found.position, position), 1e-6) << motion::info_of(joint).name;
    EXPECT_EQ(found.confidence, confidence) << motion::info_of(joint).name;
    EXPECT_EQ(found.measured, measured) << motion::info_of(joint).name;
}

TEST(BodyPoints, NothingGivesNothing) {
    EXPECT_FALSE(xr::pose_of_points({}));
    xr::BodyPoints far;
    far.wrists[xr::kLeft] = glm::dvec3(0, 1001, 0);
    far.wrists[xr::kRight] = glm::dvec3(NAN, 1, 0);
    far.head = xr::Pose{{0, INFINITY, 0}, {1, 0, 0, 0}};
    far.trackers[0] = glm::dvec3(0, 0, NAN);
    EXPECT_FALSE(xr::pose_of_points(far));
}

TEST(BodyPoints, HeadAndHandsAreMeasuredAndShouldersAreEstimated) {
    xr::BodyPoints points;
    points.head = kHead;
    points.wrists = {glm::dvec3(-0.3, 1, -0.2), glm::dvec3(0.3, 1.1, -0.2)};
    const auto pose = xr::pose_of_points(points);
    ASSERT_TRUE(pose);
    expect_at(*pose, Joint::kNose, {0, 1.56, -0.02}, 1, true);
    expect_at(*pose, Joint::kLeftWrist, {-0.3, 1, -0.2}, 1, true);
    expect_at(*pose, Joint::kRightWrist, {0.3, 1.1, -0.2}, 1, true);
    expect_at(*pose, Joint::kNeck, {0, 1.39, 0.09}, 0.2, false);
    expect_at(*pose, Joint::kLeftShoulder, {-0.18, 1.39, 0.09}, 0.2, false);
    expect_at(*pose, Joint::kRightShoulder, {0.18, 1.39, 0.09}, 0.2, false);
    EXPECT_EQ(count_measured(*pose), 3u);
    for (const Joint joint : {Joint::kPelvis, Joint::kLeftHip, Joint::kRightElbow, Joint::kLeftAnkle})
        EXPECT_EQ(motion::at(*pose, joint).confidence, 0) << motion::info_of(joint).name;
}

TEST(BodyPoints, EstimatedShouldersFollowTheHeadsHeading) {
    xr::BodyPoints points;
    points.head = xr::Pose{{1, 1.7, 2}, xr::turn_by(glm::radians(90.0))};  // the head looks along −X
    const auto pose = xr::pose_of_points(points);
    ASSERT_TRUE(pose);
    expect_at(*pose, Joint::kNose, {0.98, 1.66, 2}, 1, true);
    expect_at(*pose, Joint::kRightShoulder, {1.09, 1.49, 1.82}, 0.2, false);
    expect_at(*pose, Joint::kLeftShoulder, {1.09, 1.49, 2.18}, 0.2, false);
}

TEST(BodyPoints, TrackersAreTheJointsThatTheyAreWornAt) {
    xr::BodyPoints points;
    points.head = kHead;
    for (size_t i = 0; i < xr::kTrackers; ++i) points.trackers[i] = glm::dvec3(0.1, 0.2, 0.1 * static_cast<double>(i));
    const auto pose = xr::pose_of_points(points);
    ASSERT_TRUE(pose);
    for (size_t i = 0; i < xr::kTrackers; ++i)
        expect_at(*pose, xr::kTrackerRoles[i].joint, *points.trackers[i], 0.8, true);
    const glm::dvec3 centre =
        (motion::at(*pose, Joint::kLeftShoulder).position + motion::at(*pose, Joint::kRightShoulder).position) / 2.0;
    expect_at(*pose, Joint::kNeck, centre, 0.8, true);
    EXPECT_FALSE(motion::at(*pose, Joint::kLeftHip).measured);
    EXPECT_EQ(motion::at(*pose, Joint::kLeftHip).confidence, 0.2);
}

TEST(BodyPoints, AWristIsTheJointOfABareHandOrBehindThePalm) {
    xr::HandInput input;
    EXPECT_FALSE(xr::wrist_of(input, {}));
    input.grip = xr::Pose{{1, 2, 3}, glm::angleAxis(glm::radians(90.0), glm::dvec3(0, 0, 1))};  // its +Y is −X
    EXPECT_LT(glm::distance(*xr::wrist_of(input, {}), glm::dvec3(0.93, 2, 3)), 1e-9);
    xr::HandJoints joints(XR_HAND_JOINT_COUNT_EXT);
    joints[XR_HAND_JOINT_WRIST_EXT].position = {5, 6, 7};
    EXPECT_EQ(*xr::wrist_of(input, joints), glm::dvec3(5, 6, 7));
}

TEST(BodyJoints, ConfidenceIsClampedAndBelongsToTheWholeBody) {
    constexpr XrSpaceLocationFlags kTracked =
        XR_SPACE_LOCATION_POSITION_VALID_BIT | XR_SPACE_LOCATION_POSITION_TRACKED_BIT;
    const std::vector<xr::BodyJointLocation> joints(XR_BODY_JOINT_COUNT_BD, {kTracked, {1, 2, 3}});
    const auto knee = [&](double confidence) {
        return motion::at(xr::pose_of_body(joints, xr::kBdBodySources, confidence), Joint::kLeftKnee);
    };
    EXPECT_EQ(knee(0.25).confidence, 0.25);
    EXPECT_EQ(knee(7).confidence, 1);
    for (const double none : {0.0, -1.0, static_cast<double>(NAN)}) {
        EXPECT_EQ(knee(none).confidence, 0) << none;
        EXPECT_FALSE(knee(none).measured) << none;
    }
}

TEST(BodyJoints, FewerJointsThanTheTableHasAreUnknown) {
    EXPECT_FALSE(xr::has_joints(xr::pose_of_body({}, xr::kMetaBodySources, 1)));
}

}  // namespace
}  // namespace neuvv::test
