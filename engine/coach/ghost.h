// The trainee inside of the trainer: a skeleton with the trainer's proportions, and arrows to where joints should be.
#pragma once

#include <vector>

#include "coach/body.h"
#include "motion/video/best_view.h"

namespace neuvv::coach {

// The trainee's pose with the trainer's place and proportions: turned about +Y by −yaw, its root on the trainer's, each
// bone as long as the trainer's. Joints that are unknown in one of them are unknown.
motion::Pose ghost_of(const motion::Pose& trainee, const motion::Pose& trainer, double yaw);

// From a joint of the ghost to the same joint of the trainer. The space is the trainer's, metres.
struct JointError {
    motion::Joint joint = motion::Joint::kPelvis;
    glm::dvec3 from{0}, to{0};
    double weight = 0;  // how red its limb is, 0..1
    motion::WeightedError weighted() const { return {to - from, weight}; }
};

// Of the joints of red limbs that are measured in both and more than 3 cm apart.
std::vector<JointError> joint_errors(const motion::Pose& ghost, const motion::Pose& trainer, const LimbValues& red);

}  // namespace neuvv::coach
