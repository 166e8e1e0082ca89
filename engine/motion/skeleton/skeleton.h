// The motion of a body: where its joints are in each frame of a clip.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "base/error.h"
#include "motion/skeleton/joints.h"

namespace neuvv::motion {

struct JointSample {
    glm::dvec3 position{0};  // metres, in the space of the volumetric video or of the file that was read; +Y is up
    double confidence = 0;   // 0..1; 0: nothing is known of this joint, and the position means nothing
    bool measured = false;   // false: derived from other joints or guessed, so it is not scored
};

using Pose = std::array<JointSample, kJoints>;

inline JointSample& at(Pose& pose, Joint joint) {
    return pose[index_of(joint)];
}
inline const JointSample& at(const Pose& pose, Joint joint) {
    return pose[index_of(joint)];
}

// A pose between two: positions are mixed; what only one of them knows is taken from it.
Pose mixed(const Pose& a, const Pose& b, double share);

// The pose as a mirror shows it: x is negated, and left and right are exchanged.
Pose mirrored(const Pose& pose);

constexpr size_t kMaxSkeletonFrames = 500'000;

struct SkeletonClip {
    double fps = 25;
    std::vector<Pose> frames;  // never empty in a clip that a function of this module returned
    std::vector<Note> notes;   // what a reader of files chose or found odd, a line each
};

// The pose at a time in frames, which may lie between two; before the first and after the last frame it is theirs.
Pose pose_at(const SkeletonClip& clip, double frame);

// Whether knees bend, and feet and nose that were measured point, to the back of what left and right say of the body:
// then they are exchanged, or the motion is a mirror image.
bool faces_backwards(const SkeletonClip& clip);

// Throws InputError where a joint is not at a finite position within 1000 km.
void expect_finite(const SkeletonClip& clip, const std::string& file);

// The median over the frames of the distance from each joint to its parent, metres; 0 for the pelvis and for bones that
// no frame has.
std::array<double, kJoints> bone_lengths(const SkeletonClip& clip);

// How tall the body stands, metres: leg, trunk, and what lies above the neck as a share of the trunk. It is what
// errors are given relative to. 0 where no leg or no trunk is known.
double body_height(const std::array<double, kJoints>& bones);

}  // namespace neuvv::motion
