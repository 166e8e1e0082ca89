#include "motion/skeleton/skeleton.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"

#include "motion/skeleton/median.h"

namespace neuvv::motion {

Pose mixed(const Pose& a, const Pose& b, double share) {
    Pose pose;
    for (size_t j = 0; j < kJoints; ++j) {
        if (!(a[j].confidence > 0) || !(b[j].confidence > 0)) {
            pose[j] = a[j].confidence > 0 ? a[j] : b[j];
            continue;
        }
        pose[j].position = glm::mix(a[j].position, b[j].position, share);
        pose[j].confidence = glm::mix(a[j].confidence, b[j].confidence, share);
        pose[j].measured = a[j].measured && b[j].measured;
    }
    return pose;
}

Pose mirrored(const Pose& pose) {
    Pose result;
    for (size_t j = 0; j < kJoints; ++j) {
        JointSample& sample = at(result, info_of(joint_at(j)).mirrored);
        sample = pose[j];
        sample.position.x = -sample.position.x;
    }
    return result;
}

Pose pose_at(const SkeletonClip& clip, double frame) {
    const double last = static_cast<double>(clip.frames.size()) - 1, at = std::clamp(frame, 0.0, last);
    const auto first = static_cast<size_t>(at);
    const double share = at - static_cast<double>(first);
    return share > 0 ? mixed(clip.frames[first], clip.frames[first + 1], share) : clip.frames[first];
}

namespace {

// How far knees and feet are in front of the legs, and the nose in front of the trunk, as the sides across and up along
// each say where that is, in lengths of the trunk; 0 where that is not known. It is the same in all postures.
double reach_forwards(const Pose& pose) {
    using enum Joint;
    const auto known = [&](Joint joint) { return at(pose, joint).confidence > 0 && at(pose, joint).measured; };
    const auto from = [&](Joint begin, Joint end) { return at(pose, end).position - at(pose, begin).position; };
    const auto ahead = [](const glm::dvec3& across, const glm::dvec3& up, const glm::dvec3& reach) {
        const glm::dvec3 front = glm::cross(across, up);
        return glm::length(front) > 0 ? glm::dot(reach, glm::normalize(front)) : 0;
    };
    if (!known(kLeftHip) || !known(kRightHip) || !known(kPelvis) || !known(kNeck)) return 0;
    const glm::dvec3 hips = from(kRightHip, kLeftHip), trunk = from(kPelvis, kNeck);
    double reach = known(kNose) ? ahead(hips, trunk, from(kNeck, kNose)) : 0;
    for (const auto& [hip, knee, ankle, toe] : {std::array{kLeftHip, kLeftKnee, kLeftAnkle, kLeftBigToe},
                                                std::array{kRightHip, kRightKnee, kRightAnkle, kRightBigToe}}) {
        if (!known(knee) || !known(ankle)) continue;
        reach += ahead(hips, from(ankle, hip), 0.5 * (from(hip, knee) + from(ankle, knee)));
        if (known(toe)) reach += ahead(hips, from(ankle, knee), from(ankle, toe));
    }
    return glm::length(trunk) > 0 ? reach / glm::length(trunk) : 0;
}

}  // namespace

bool faces_backwards(const SkeletonClip& clip) {
    constexpr double kClearly = 0.1;  // of the trunk's length: straight legs and a bowed head are no evidence
    std::vector<double> reaches;
    for (const Pose& pose : clip.frames) reaches.push_back(reach_forwards(pose));
    return median(reaches) < -kClearly;
}

void expect_finite(const SkeletonClip& clip, const std::string& file) {
    constexpr double kFarthest_m = 1e6;
    for (size_t f = 0; f < clip.frames.size(); ++f)
        for (size_t j = 0; j < kJoints; ++j)
            if (!(glm::length(clip.frames[f][j].position) <= kFarthest_m))
                throw InputError(file, fmt::format("frame {}", f),
                                 fmt::format("has its {} more than 1000 km away", info_of(joint_at(j)).name),
                                 "scale the motion to metres");
}

std::array<double, kJoints> bone_lengths(const SkeletonClip& clip) {
    std::array<double, kJoints> lengths{};
    std::vector<double> seen;
    for (size_t j = 1; j < kJoints; ++j) {
        const Joint parent = info_of(joint_at(j)).parent;
        seen.clear();
        for (const Pose& pose : clip.frames)
            if (pose[j].confidence > 0 && at(pose, parent).confidence > 0)
                seen.push_back(glm::distance(pose[j].position, at(pose, parent).position));
        lengths[j] = median(seen);
    }
    return lengths;
}

double body_height(const std::array<double, kJoints>& bones) {
    const auto leg = [&](Joint knee, Joint ankle, Joint heel) {
        return bones[index_of(knee)] * bones[index_of(ankle)] > 0
                   ? bones[index_of(knee)] + bones[index_of(ankle)] + bones[index_of(heel)]
                   : 0;
    };
    const double legs = std::max(leg(Joint::kLeftKnee, Joint::kLeftAnkle, Joint::kLeftHeel),
                                 leg(Joint::kRightKnee, Joint::kRightAnkle, Joint::kRightHeel));
    const double trunk = bones[index_of(Joint::kNeck)];
    // The neck to the top of the head is about 0.6 of the trunk.
    return legs > 0 && trunk > 0 ? legs + 1.6 * trunk : 0;
}

}  // namespace neuvv::motion
