// How far two poses are apart, limb by limb, whatever the bodies' proportions: README.md has the formulas.
#pragma once

#include <array>
#include <glm/glm.hpp>

#include "motion/skeleton/skeleton.h"

namespace neuvv::motion {

// What of a pose is compared: directions. Those of the trunk are in the world; those of head and arms are in the frame
// of the shoulders, those of legs in the frame of the hips, so that a trunk that is turned wrongly makes no limb wrong.
struct BoneDirection {
    glm::dvec3 direction{0};  // unit
    double weight = 0;        // 0: one of the joints is unknown or estimated
};
constexpr size_t kComparedBones = 14;
constexpr size_t kHipLine = 1, kShoulderLine = 2;  // the lines from right to left
using Directions = std::array<BoneDirection, kComparedBones>;

Limb limb_of_bone(size_t compared_bone);
Directions directions_of(const Pose& pose);
// A direction turned about the world's +Y, radians.
glm::dvec3 turned(const glm::dvec3& direction, double yaw);
// The directions of the pose, turned likewise.
Directions turned(const Directions& directions, double yaw);

// Errors of a frame, in degrees: for each limb the root of the weighted mean of its bones' squared angles; −1 where
// none of its bones is known in both poses.
using LimbErrors = std::array<double, kLimbs>;
LimbErrors limb_errors(const Directions& a, const Directions& b);

// Σ w ρ(1 − cos θ) / Σ w over all bones that both know, with ρ(x) = x / (1 + x / (1 − cos 15°)): a distance for finding
// times that match, in which a bone that is wrong at any time does not count for much. `without_trunk` leaves out what
// depends on where the world's axes point. 1 where no bone is known in both.
double distance(const Directions& a, const Directions& b, bool without_trunk);

// The angle about +Y by which `to` is turned from `from`, by hips and shoulders, radians; NaN where neither is known.
double yaw_between(const Directions& from, const Directions& to);

// What is forgiven, and how fast a score falls beyond, by limb, in degrees.
struct Tolerances {
    LimbErrors tolerance = {12, 18, 15, 15, 13, 13};
    double scale = 20;
};
// exp(−(max(0, e − tolerance) / scale)²), 0..1; −1 for an unknown error.
double limb_score(Limb limb, double error_deg, const Tolerances& tolerances);

}  // namespace neuvv::motion
