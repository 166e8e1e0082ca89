#include "xr/body_joints.h"

#include <algorithm>

namespace neuvv::xr {

namespace {

constexpr double kFarthest_m = 1000, kGuessed = 0.5;

struct JointSource {
    motion::Joint joint;
    int first, second;
};

template <size_t kCount>
constexpr BodyJointSources sources_of(const std::array<JointSource, kCount>& list) {
    BodyJointSources sources;
    for (std::array<int, 2>& source : sources) source = {-1, -1};
    for (const JointSource& one : list) sources[motion::index_of(one.joint)] = {one.first, one.second};
    return sources;
}

constexpr JointSource same(motion::Joint joint, int source) {
    return {joint, source, source};
}

}  // namespace

// The pelvis is the joint of the hips rather than the centre of both legs, so that it is measured where legs are
// guessed.
constinit const BodyJointSources kMetaBodySources = [] {
    using enum motion::Joint;
    return sources_of(std::array{
        same(kPelvis, XR_BODY_JOINT_HIPS_FB),
        JointSource{kNeck, XR_BODY_JOINT_LEFT_ARM_UPPER_FB, XR_BODY_JOINT_RIGHT_ARM_UPPER_FB},
        same(kRightShoulder, XR_BODY_JOINT_RIGHT_ARM_UPPER_FB),
        same(kRightElbow, XR_BODY_JOINT_RIGHT_ARM_LOWER_FB),
        same(kRightWrist, XR_BODY_JOINT_RIGHT_HAND_WRIST_FB),
        same(kLeftShoulder, XR_BODY_JOINT_LEFT_ARM_UPPER_FB),
        same(kLeftElbow, XR_BODY_JOINT_LEFT_ARM_LOWER_FB),
        same(kLeftWrist, XR_BODY_JOINT_LEFT_HAND_WRIST_FB),
        same(kRightHip, XR_FULL_BODY_JOINT_RIGHT_UPPER_LEG_META),
        same(kRightKnee, XR_FULL_BODY_JOINT_RIGHT_LOWER_LEG_META),
        same(kRightAnkle, XR_FULL_BODY_JOINT_RIGHT_FOOT_ANKLE_META),
        same(kRightBigToe, XR_FULL_BODY_JOINT_RIGHT_FOOT_BALL_META),
        same(kLeftHip, XR_FULL_BODY_JOINT_LEFT_UPPER_LEG_META),
        same(kLeftKnee, XR_FULL_BODY_JOINT_LEFT_LOWER_LEG_META),
        same(kLeftAnkle, XR_FULL_BODY_JOINT_LEFT_FOOT_ANKLE_META),
        same(kLeftBigToe, XR_FULL_BODY_JOINT_LEFT_FOOT_BALL_META),
    });
}();

constinit const BodyJointSources kBdBodySources = [] {
    using enum motion::Joint;
    return sources_of(std::array{
        JointSource{kPelvis, XR_BODY_JOINT_LEFT_HIP_BD, XR_BODY_JOINT_RIGHT_HIP_BD},
        JointSource{kNeck, XR_BODY_JOINT_LEFT_SHOULDER_BD, XR_BODY_JOINT_RIGHT_SHOULDER_BD},
        same(kRightShoulder, XR_BODY_JOINT_RIGHT_SHOULDER_BD),
        same(kRightElbow, XR_BODY_JOINT_RIGHT_ELBOW_BD),
        same(kRightWrist, XR_BODY_JOINT_RIGHT_WRIST_BD),
        same(kLeftShoulder, XR_BODY_JOINT_LEFT_SHOULDER_BD),
        same(kLeftElbow, XR_BODY_JOINT_LEFT_ELBOW_BD),
        same(kLeftWrist, XR_BODY_JOINT_LEFT_WRIST_BD),
        same(kRightHip, XR_BODY_JOINT_RIGHT_HIP_BD),
        same(kRightKnee, XR_BODY_JOINT_RIGHT_KNEE_BD),
        same(kRightAnkle, XR_BODY_JOINT_RIGHT_ANKLE_BD),
        same(kRightBigToe, XR_BODY_JOINT_RIGHT_FOOT_BD),
        same(kLeftHip, XR_BODY_JOINT_LEFT_HIP_BD),
        same(kLeftKnee, XR_BODY_JOINT_LEFT_KNEE_BD),
        same(kLeftAnkle, XR_BODY_JOINT_LEFT_ANKLE_BD),
        same(kLeftBigToe, XR_BODY_JOINT_LEFT_FOOT_BD),
    });
}();

bool is_near(const glm::dvec3& position) {
    return glm::length(position) <= kFarthest_m;  // false for NaN
}

motion::Pose pose_of_body(std::span<const BodyJointLocation> joints, const BodyJointSources& sources,
                          double confidence) {
    const double sure = confidence > 0 ? std::min(confidence, 1.0) : 0;
    motion::Pose pose;
    for (size_t j = 0; j < motion::kJoints; ++j) {
        bool is_known = sure > 0, is_tracked = true;
        glm::dvec3 sum(0);
        for (const int source : sources[j]) {
            const bool is_there = source >= 0 && static_cast<size_t>(source) < joints.size();
            const BodyJointLocation joint = is_there ? joints[static_cast<size_t>(source)] : BodyJointLocation{};
            const glm::dvec3 position(joint.position.x, joint.position.y, joint.position.z);
            is_known = is_known && (joint.flags & XR_SPACE_LOCATION_POSITION_VALID_BIT) && is_near(position);
            is_tracked = is_tracked && (joint.flags & XR_SPACE_LOCATION_POSITION_TRACKED_BIT);
            sum += position;
        }
        if (is_known) pose[j] = {sum / 2.0, is_tracked ? sure : kGuessed * sure, is_tracked};
    }
    return pose;
}

bool has_joints(const motion::Pose& pose) {
    return std::any_of(pose.begin(), pose.end(), [](const motion::JointSample& joint) { return joint.confidence > 0; });
}

}  // namespace neuvv::xr
