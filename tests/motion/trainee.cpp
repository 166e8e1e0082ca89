#include "motion/trainee.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <random>

namespace neuvv::test {

namespace {

using motion::Joint;
using motion::Limb;
using motion::Pose;

double time_of(const motion::SkeletonClip& clip, size_t frame) {
    return static_cast<double>(frame) / clip.fps;
}

std::vector<Joint> joints_of(Limb limb) {
    using enum Joint;
    switch (limb) {
        case Limb::kRightArm:
            return {kRightShoulder, kRightElbow, kRightWrist};
        case Limb::kLeftArm:
            return {kLeftShoulder, kLeftElbow, kLeftWrist};
        case Limb::kRightLeg:
            return {kRightHip, kRightKnee, kRightAnkle, kRightHeel, kRightBigToe, kRightSmallToe};
        default:
            return {kLeftHip, kLeftKnee, kLeftAnkle, kLeftHeel, kLeftBigToe, kLeftSmallToe};
    }
}

glm::dvec3 place_of(const Pose& pose, Joint joint) {
    return motion::at(pose, joint).position;
}

// Axes of the hips: left, up along the trunk, forward.
glm::dmat3 hips_of(const Pose& pose) {
    const glm::dvec3 x = glm::normalize(place_of(pose, Joint::kLeftHip) - place_of(pose, Joint::kRightHip));
    const glm::dvec3 up = place_of(pose, Joint::kNeck) - place_of(pose, Joint::kPelvis);
    const glm::dvec3 z = glm::normalize(glm::cross(x, up));
    return {x, glm::cross(z, x), z};
}

double yaw_of_hips(const Pose& pose) {
    const glm::dvec3 across = place_of(pose, Joint::kLeftHip) - place_of(pose, Joint::kRightHip);
    return std::atan2(-across.z, across.x);
}

}  // namespace

motion::SkeletonClip at_speed(const motion::SkeletonClip& clip, double speed) {
    motion::SkeletonClip result;
    result.fps = clip.fps;
    const auto frames = static_cast<size_t>(static_cast<double>(clip.frames.size() - 1) / speed) + 1;
    for (size_t f = 0; f < frames; ++f) result.frames.push_back(motion::pose_at(clip, static_cast<double>(f) * speed));
    return result;
}

motion::SkeletonClip other_body(const motion::SkeletonClip& clip, double scale, const glm::dvec3& place, double yaw) {
    const glm::dmat3 turn(glm::rotate(glm::dmat4(1), yaw, glm::dvec3(0, 1, 0)));
    motion::SkeletonClip result = clip;
    for (Pose& pose : result.frames)
        for (motion::JointSample& sample : pose) sample.position = place + turn * (scale * sample.position);
    return result;
}

motion::SkeletonClip with_noise(const motion::SkeletonClip& clip, double deviation_m, uint32_t seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, deviation_m);
    motion::SkeletonClip result = clip;
    for (Pose& pose : result.frames)
        for (motion::JointSample& sample : pose)
            sample.position += glm::dvec3(normal(random), normal(random), normal(random));
    return result;
}

motion::SkeletonClip with_arm_off(const motion::SkeletonClip& clip, Limb arm, double angle_deg, double first_s,
                                  double last_s) {
    motion::SkeletonClip result = clip;
    const std::vector<Joint> joints = joints_of(arm);
    for (size_t f = 0; f < clip.frames.size(); ++f) {
        const double t = time_of(clip, f);
        if (t < first_s || t > last_s) continue;
        Pose& pose = result.frames[f];
        const glm::dvec3 shoulder = place_of(pose, joints[0]);
        // An axis across both bones, so that both turn by the whole angle.
        glm::dvec3 axis = glm::cross(place_of(pose, joints[1]) - shoulder, place_of(pose, joints[2]) - shoulder);
        if (!(glm::length(axis) > 1e-4)) axis = hips_of(pose)[2];
        const glm::dquat turn = glm::angleAxis(glm::radians(angle_deg), glm::normalize(axis));
        for (size_t j = 1; j < joints.size(); ++j) {
            glm::dvec3& position = motion::at(pose, joints[j]).position;
            position = shoulder + turn * (position - shoulder);
        }
    }
    return result;
}

motion::SkeletonClip with_late_leg(const motion::SkeletonClip& clip, Limb leg, double late_s, double first_s,
                                   double last_s) {
    motion::SkeletonClip result = clip;
    const std::vector<Joint> joints = joints_of(leg);
    for (size_t f = 0; f < clip.frames.size(); ++f) {
        const double t = time_of(clip, f);
        if (t < first_s || t > last_s) continue;
        const Pose before = motion::pose_at(clip, static_cast<double>(f) - late_s * clip.fps);
        Pose& pose = result.frames[f];
        const glm::dmat3 turn = hips_of(pose) * glm::transpose(hips_of(before));
        for (size_t j = 1; j < joints.size(); ++j)
            motion::at(pose, joints[j]).position =
                place_of(pose, joints[0]) + turn * (place_of(before, joints[j]) - place_of(before, joints[0]));
    }
    return result;
}

motion::SkeletonClip with_mirrored_turn(const motion::SkeletonClip& clip, double ahead, double first_s, double last_s) {
    motion::SkeletonClip result = clip;
    for (size_t f = 0; f < clip.frames.size(); ++f) {
        const double t = time_of(clip, f);
        if (t < first_s || t > last_s) continue;
        Pose& pose = result.frames[f];
        const double off = std::remainder(yaw_of_hips(pose) - ahead, 2 * std::numbers::pi);
        const glm::dvec3 pelvis = place_of(pose, Joint::kPelvis);
        const glm::dmat3 turn(glm::rotate(glm::dmat4(1), -2 * off, glm::dvec3(0, 1, 0)));
        for (motion::JointSample& sample : pose) sample.position = pelvis + turn * (sample.position - pelvis);
    }
    return result;
}

double facing_of(const motion::SkeletonClip& clip) {
    std::vector<double> yaws;
    for (const Pose& pose : clip.frames) yaws.push_back(yaw_of_hips(pose));
    std::ranges::sort(yaws);
    return yaws[yaws.size() / 2];
}

}  // namespace neuvv::test
