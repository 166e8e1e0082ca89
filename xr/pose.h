// Where something is and how it is turned, in double precision: what OpenXR calls a pose.
//
// Right-handed, +Y up, metres; hands and heads look along −Z, their right is +X.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "base/box.h"

namespace neuvv::xr {

// `world_from_hand`, as a matrix would be named. The rotation is a unit quaternion; a runtime's floats are near enough.
struct Pose {
    glm::dvec3 position{0};
    glm::dquat rotation{1, 0, 0, 0};  // w, x, y, z
};

// Whether a tracker can have meant it: finite, within 1000 km, its rotation more or less of unit length.
inline bool is_sound(const Pose& pose) {
    constexpr double kFarthest_m = 1e6, kLeastSquare = 0.25, kMostSquare = 4;
    const double square = glm::dot(pose.rotation, pose.rotation);  // comparisons with NaN are false
    for (int i = 0; i < 3; ++i)
        if (!(std::abs(pose.position[i]) <= kFarthest_m)) return false;
    return square >= kLeastSquare && square <= kMostSquare;
}

inline glm::dmat4 matrix_of(const Pose& pose) {
    glm::dmat4 matrix = glm::mat4_cast(glm::normalize(pose.rotation));
    matrix[3] = glm::dvec4(pose.position, 1);
    return matrix;
}

// A point of the posed thing's space, carried out of it.
inline glm::dvec3 operator*(const Pose& pose, glm::dvec3 point) {
    return pose.position + glm::normalize(pose.rotation) * point;
}

// a ∘ b: first b, then a.
inline Pose operator*(const Pose& a, const Pose& b) {
    return {a * b.position, glm::normalize(a.rotation * b.rotation)};
}

inline Pose inverse(const Pose& pose) {
    const glm::dquat back = glm::conjugate(glm::normalize(pose.rotation));
    return {back * -pose.position, back};
}

inline glm::dvec3 forward_of(const Pose& pose) {
    return glm::normalize(pose.rotation) * glm::dvec3(0, 0, -1);
}

inline Ray ray_of(const Pose& aim) {
    return {aim.position, forward_of(aim)};
}

// About +Y.
inline glm::dquat turn_by(double yaw_rad) {
    return glm::angleAxis(yaw_rad, glm::dvec3(0, 1, 0));
}

// The heading: the angle about +Y, −π to π, by which −Z turns to where −Z looks, seen from above; yaw_of(turn_by(a)) is
// a. Straight up or down the top of the head says it: what it is when the head comes back to the level, nodding.
inline double yaw_of(const glm::dquat& rotation) {
    constexpr double kVertical = 1e-4;  // sine of the angle to the vertical
    const glm::dquat unit = glm::normalize(rotation);
    glm::dvec3 ahead = unit * glm::dvec3(0, 0, -1);
    if (std::hypot(ahead.x, ahead.z) < kVertical) ahead = unit * glm::dvec3(0, ahead.y > 0 ? -1 : 1, 0);
    return std::atan2(-ahead.x, -ahead.z);
}

// How much of a turn is about +Y, −π to π (swing and twist): whatever the turn tilts besides. It adds up with turns
// about +Y before and after. Ill defined where the tilt comes near half a turn, see tilt_cosine_of.
inline double twist_of(const glm::dquat& turn) {
    return std::remainder(2 * std::atan2(turn.y, turn.w), 2 * glm::pi<double>());
}
// Cosine of half the tilt's angle, 0 to 1.
inline double tilt_cosine_of(const glm::dquat& turn) {
    return std::hypot(turn.y, turn.w);
}

}  // namespace neuvv::xr
