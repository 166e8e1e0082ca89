#include "coach/body.h"

#include <algorithm>

namespace neuvv::coach {

namespace {

// The radius of the bone that ends at each joint, as a share of the height of the body. Twice of it is the thickness
// that anthropometric tables give; the trunk's bones lie between hips and shoulders, so theirs is half of its depth.
double radius_of(motion::Joint joint) {
    using enum motion::Joint;
    switch (joint) {
        case kNeck:
            return 0.075;
        case kNose:
            return 0.065;
        case kRightShoulder:
        case kLeftShoulder:
            return 0.035;
        case kRightHip:
        case kLeftHip:
            return 0.055;
        case kRightElbow:
        case kLeftElbow:
            return 0.03;
        case kRightWrist:
        case kLeftWrist:
            return 0.025;
        case kRightKnee:
        case kLeftKnee:
            return 0.045;
        case kRightAnkle:
        case kLeftAnkle:
            return 0.03;
        default:
            return 0.02;  // feet
    }
}

// From above the neck, so that shoulders stay with the trunk, to the centre of the skull: behind the nose, as the
// shoulders face, and a little above it.
BodyBone head_of(const motion::Pose& pose, double height, float radius) {
    using enum motion::Joint;
    const auto place = [&pose](motion::Joint joint) { return motion::at(pose, joint).position; };
    const auto known = [&pose](motion::Joint joint) { return motion::at(pose, joint).confidence > 0; };
    glm::dvec3 skull = place(kNose);
    if (known(kLeftShoulder) && known(kRightShoulder)) {
        const glm::dvec3 up = place(kNose) - place(kNeck);
        const glm::dvec3 ahead = glm::cross(place(kLeftShoulder) - place(kRightShoulder), up);
        if (glm::length(ahead) > 1e-6 && glm::length(up) > 1e-6)
            skull += height * (0.02 * glm::normalize(up) - 0.05 * glm::normalize(ahead));
    }
    return {{glm::mix(place(kNeck), skull, 0.5), skull, radius}, motion::Limb::kHead};
}

}  // namespace

std::vector<BodyBone> body_of(const motion::Pose& pose, double height) {
    std::vector<BodyBone> body;
    for (size_t j = 1; j < motion::kJoints; ++j) {
        const motion::JointInfo& info = motion::info_of(motion::joint_at(j));
        const motion::JointSample &end = pose[j], &begin = motion::at(pose, info.parent);
        if (!(end.confidence > 0) || !(begin.confidence > 0)) continue;
        const auto radius = static_cast<float>(radius_of(motion::joint_at(j)) * height);
        if (motion::joint_at(j) == motion::Joint::kNose)
            body.push_back(head_of(pose, height, radius));
        else
            body.push_back({{begin.position, end.position, radius}, info.limb});
    }
    return body;
}

render::Highlight highlight_of(const std::vector<BodyBone>& body, const LimbValues& red) {
    render::Highlight highlight;
    for (const BodyBone& each : body) {
        highlight.bones.push_back(each.bone);
        highlight.tints.push_back(static_cast<float>(red[motion::index_of(each.limb)]));
    }
    return highlight;
}

}  // namespace neuvv::coach
