// Solves for the changes of all cameras' poses from how images depend on them: one round of Gauss and Newton's method.
#pragma once

#include "training/rig/camera_pose.h"

namespace neuvv::training {

constexpr double kLargeError = 0.2;  // of a pixel, in encoded values; larger ones count linearly (Huber)

// Normal equations of seven numbers, those of a camera's pose or of a whole rig's (align_rig.h): ½ Δᵀ normal Δ − rightᵀ
// Δ is half of the squared error of its pixels after a change by Δ, up to a constant.
struct PoseEvidence {
    std::array<PoseChange, kPoseNumbers> normal{};
    PoseChange right{};
    double error = 0, count = 0;  // the sum of weighted squared residuals, and how many there are

    // Adds a residual (render minus truth) with its derivatives by the numbers of the pose.
    void add(double residual, const PoseChange& derivatives, double weight);
};

// The change after which the squared error is least, without a prior: numbers that images say nothing of stay. The
// numbers must be of comparable size.
PoseChange solution_of(const PoseEvidence& evidence);

// The next changes: nearer to those that fit the images, weighed against a prior that the calibration is nearly right.
// Images say nothing of a motion, a turn or a scaling of all cameras and the performer together: that common part is
// taken out, so that the rig as a whole stays where its calibration has it. No number moves by more than two steps of
// `pixels` (pose_steps), nor beyond its bounds. All vectors have one element by camera (assert).
std::vector<PoseChange> next_poses(const std::vector<stage::Camera>& given, const std::vector<PoseChange>& changes,
                                   const std::vector<PoseEvidence>& evidence, glm::dvec3 centre, double pixels);

}  // namespace neuvv::training
