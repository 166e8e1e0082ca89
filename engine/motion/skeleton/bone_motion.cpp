#include "motion/skeleton/bone_motion.h"

#include <cmath>
#include <numbers>

namespace neuvv::motion {

namespace {

// The joint to which a joint's bone leads, or the joint itself at the end of a limb.
Joint next_of(Joint joint) {
    using enum Joint;
    switch (joint) {
        case kRightShoulder:
            return kRightElbow;
        case kRightElbow:
            return kRightWrist;
        case kLeftShoulder:
            return kLeftElbow;
        case kLeftElbow:
            return kLeftWrist;
        case kRightHip:
            return kRightKnee;
        case kRightKnee:
            return kRightAnkle;
        case kRightAnkle:
            return kRightBigToe;
        case kLeftHip:
            return kLeftKnee;
        case kLeftKnee:
            return kLeftAnkle;
        case kLeftAnkle:
            return kLeftBigToe;
        default:
            return joint;
    }
}

// The axes of a body's part from a direction across it and one along it; identity where they are parallel.
glm::dquat axes_of(glm::dvec3 across, glm::dvec3 along) {
    const glm::dvec3 forward = glm::cross(across, along);
    if (!(glm::length(forward) > 1e-9)) return {1, 0, 0, 0};
    const glm::dvec3 z = glm::normalize(forward), y = glm::normalize(along);
    return glm::quat_cast(glm::dmat3(glm::cross(y, z), y, z));
}

// World rotations of the joints relative to the rest pose.
std::array<glm::dquat, kJoints> rotations_of(const Positions& rest, const Positions& now) {
    const auto bone = [](const Positions& p, Joint from, Joint to) { return p[index_of(to)] - p[index_of(from)]; };
    const auto trunk = [&](const Positions& p, Joint right, Joint left) {
        return axes_of(bone(p, right, left), bone(p, Joint::kPelvis, Joint::kNeck));
    };
    std::array<glm::dquat, kJoints> world;
    for (size_t j = 0; j < kJoints; ++j) {
        const Joint joint = joint_at(j), next = next_of(joint);
        const glm::dquat parent = j == 0 ? glm::dquat(1, 0, 0, 0) : world[index_of(info_of(joint).parent)];
        if (joint == Joint::kPelvis)
            world[j] = trunk(now, Joint::kRightHip, Joint::kLeftHip) *
                       glm::conjugate(trunk(rest, Joint::kRightHip, Joint::kLeftHip));
        else if (joint == Joint::kNeck)
            world[j] = trunk(now, Joint::kRightShoulder, Joint::kLeftShoulder) *
                       glm::conjugate(trunk(rest, Joint::kRightShoulder, Joint::kLeftShoulder));
        else
            world[j] =
                next == joint ? parent : swing(parent * bone(rest, joint, next), bone(now, joint, next)) * parent;
    }
    return world;
}

}  // namespace

std::vector<Positions> filled_positions(const SkeletonClip& clip) {
    std::vector<Positions> filled(clip.frames.size());
    for (size_t j = 0; j < kJoints; ++j) {
        const size_t parent = index_of(info_of(joint_at(j)).parent);
        size_t first = 0;
        while (first < clip.frames.size() && clip.frames[first][j].confidence <= 0) ++first;
        for (size_t f = 0; f < clip.frames.size(); ++f) {
            const JointSample& sample = clip.frames[std::max(f, std::min(first, clip.frames.size() - 1))][j];
            if (first == clip.frames.size())
                filled[f][j] = parent == j ? glm::dvec3(0) : filled[f][parent];
            else
                filled[f][j] = sample.confidence > 0 ? sample.position : filled[f - 1][j];
        }
    }
    return filled;
}

std::array<BoneTransform, kJoints> bone_transforms(const Positions& rest, const Positions& now) {
    const std::array<glm::dquat, kJoints> world = rotations_of(rest, now);
    std::array<BoneTransform, kJoints> bones;
    for (size_t j = 0; j < kJoints; ++j) {
        const size_t parent = index_of(info_of(joint_at(j)).parent);
        const glm::dquat back = j == 0 ? glm::dquat(1, 0, 0, 0) : glm::conjugate(world[parent]);
        bones[j] = {j == 0 ? now[0] : back * (now[j] - now[parent]), glm::normalize(back * world[j])};
    }
    return bones;
}

glm::dquat swing(glm::dvec3 from, glm::dvec3 to) {
    if (!(glm::length(from) > 1e-9 && glm::length(to) > 1e-9)) return {1, 0, 0, 0};
    from = glm::normalize(from);
    to = glm::normalize(to);
    const double cosine = glm::dot(from, to);
    if (cosine > 1 - 1e-12) return {1, 0, 0, 0};
    if (cosine < -1 + 1e-9) {
        const glm::dvec3 side = std::abs(from.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
        return glm::angleAxis(std::numbers::pi, glm::normalize(glm::cross(from, side)));
    }
    return glm::normalize(glm::dquat(1 + cosine, glm::cross(from, to)));
}

}  // namespace neuvv::motion
