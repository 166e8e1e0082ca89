#include "xr/body_points.h"

#include "xr/body_joints.h"

namespace neuvv::xr {

namespace {

using motion::Joint;

constexpr double kWorn = 0.8, kPlaced = 0.2;
constexpr double kWristBehindPalm_m = 0.07;
// Of an adult, metres: the nose and the top of the neck from between the eyes, and the centre of the shoulders from
// there; half of the distance between shoulders, and between hips.
constexpr glm::dvec3 kNoseFromEyes(0, -0.04, -0.02), kSkullFromEyes(0, -0.08, 0.09), kNeckFromSkull(0, -0.13, 0);
constexpr double kHalfShoulders_m = 0.18, kHalfHips_m = 0.09;

void place(motion::Pose& pose, Joint joint, const glm::dvec3& position, double confidence, bool measured) {
    if (is_near(position)) motion::at(pose, joint) = {position, confidence, measured};
}

void place_unknown(motion::Pose& pose, Joint joint, const glm::dvec3& position) {
    if (!(motion::at(pose, joint).confidence > 0)) place(pose, joint, position, kPlaced, false);
}

void place_neck_between_trackers(motion::Pose& pose) {
    const motion::JointSample &left = at(pose, Joint::kLeftShoulder), &right = at(pose, Joint::kRightShoulder);
    if (left.confidence > 0 && right.confidence > 0)
        place(pose, Joint::kNeck, (left.position + right.position) / 2.0, kWorn, true);
}

// What hangs on the head, as if the body faced where the head does.
void place_by_proportions(motion::Pose& pose, const Pose& head) {
    const glm::dvec3 to_right = turn_by(yaw_of(head.rotation)) * glm::dvec3(1, 0, 0);
    place_unknown(pose, Joint::kNeck, head * kSkullFromEyes + kNeckFromSkull);
    const motion::JointSample &neck = at(pose, Joint::kNeck), &pelvis = at(pose, Joint::kPelvis);
    if (neck.confidence > 0) {
        place_unknown(pose, Joint::kRightShoulder, neck.position + kHalfShoulders_m * to_right);
        place_unknown(pose, Joint::kLeftShoulder, neck.position - kHalfShoulders_m * to_right);
    }
    if (pelvis.confidence > 0) {
        place_unknown(pose, Joint::kRightHip, pelvis.position + kHalfHips_m * to_right);
        place_unknown(pose, Joint::kLeftHip, pelvis.position - kHalfHips_m * to_right);
    }
}

}  // namespace

std::optional<glm::dvec3> wrist_of(const HandInput& input, const HandJoints& joints) {
    if (joints.size() > XR_HAND_JOINT_WRIST_EXT) return joints[XR_HAND_JOINT_WRIST_EXT].position;
    if (!input.grip) return std::nullopt;
    return *input.grip * glm::dvec3(0, kWristBehindPalm_m, 0);
}

glm::dvec3 nose_of(const Pose& head) {
    return head * kNoseFromEyes;
}

std::optional<motion::Pose> pose_of_points(const BodyPoints& points) {
    motion::Pose pose;
    for (size_t i = 0; i < kTrackers; ++i)
        if (points.trackers[i]) place(pose, kTrackerRoles[i].joint, *points.trackers[i], kWorn, true);
    place_neck_between_trackers(pose);
    if (points.wrists[kLeft]) place(pose, Joint::kLeftWrist, *points.wrists[kLeft], 1, true);
    if (points.wrists[kRight]) place(pose, Joint::kRightWrist, *points.wrists[kRight], 1, true);
    if (points.head && is_valid(*points.head)) {
        place(pose, Joint::kNose, nose_of(*points.head), 1, true);
        place_by_proportions(pose, *points.head);
    }
    return has_joints(pose) ? std::optional(pose) : std::nullopt;
}

}  // namespace neuvv::xr
