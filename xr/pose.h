// Poses as OpenXR defines them: a position and a rotation, here in double precision.
//
// Spaces are right-handed with +Y up, in metres. Hands and heads look along −Z; +X is to their right.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "base/box.h"

namespace neuvv::xr {

// Variables are named as matrices are: `world_from_hand`. The rotation is a unit quaternion; it may be as inexact as a
// runtime's floats are, as the functions below normalise it.
struct Pose {
    glm::dvec3 position{0};
    glm::dquat rotation{1, 0, 0, 0};  // w, x, y, z
};

// Whether the pose can be a tracked one: finite, within 1000 km of the origin, and with a rotation whose length is
// between 0.5 and 2.
inline bool is_valid(const Pose& pose) {
    constexpr double kMaxDistance_m = 1e6, kMinSquare = 0.25, kMaxSquare = 4;
    const double square = glm::dot(pose.rotation, pose.rotation);  // comparisons with NaN are false
    for (int i = 0; i < 3; ++i)
        if (!(std::abs(pose.position[i]) <= kMaxDistance_m)) return false;
    return square >= kMinSquare && square <= kMaxSquare;
}

inline glm::dmat4 matrix_of(const Pose& pose) {
    glm::dmat4 matrix = glm::mat4_cast(glm::normalize(pose.rotation));
    matrix[3] = glm::dvec4(pose.position, 1);
    return matrix;
}

// Transforms a point out of the pose's space: world_from_hand * point_in_hand.
inline glm::dvec3 operator*(const Pose& pose, glm::dvec3 point) {
    return pose.position + glm::normalize(pose.rotation) * point;
}

// Composes two poses: a * b applies b first, then a.
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

// A rotation about +Y.
inline glm::dquat turn_by(double yaw_rad) {
    return glm::angleAxis(yaw_rad, glm::dvec3(0, 1, 0));
}

// The heading, −π to π: the angle about +Y by which the world's −Z turns to the rotated −Z, seen from above;
// yaw_of(turn_by(a)) is a. Where the rotated −Z points straight up or down, the top of the head (+Y) defines the
// heading: the result is the one that the head has after it nods back to the horizontal.
inline double yaw_of(const glm::dquat& rotation) {
    constexpr double kVertical = 1e-4;  // sine of the angle to the vertical
    const glm::dquat unit = glm::normalize(rotation);
    glm::dvec3 ahead = unit * glm::dvec3(0, 0, -1);
    if (std::hypot(ahead.x, ahead.z) < kVertical) ahead = unit * glm::dvec3(0, ahead.y > 0 ? -1 : 1, 0);
    return std::atan2(-ahead.x, -ahead.z);
}

// The part of a rotation that is about +Y, −π to π: the twist of a swing-twist decomposition. Rotations about +Y before
// or after add to it. Ill defined where the tilt (the swing) is near half a turn, see tilt_cosine_of.
inline double twist_of(const glm::dquat& turn) {
    return std::remainder(2 * std::atan2(turn.y, turn.w), 2 * glm::pi<double>());
}
// The cosine of half the angle of the tilt, 0 to 1: 1 for a rotation about +Y alone.
inline double tilt_cosine_of(const glm::dquat& turn) {
    return std::hypot(turn.y, turn.w);
}

}  // namespace neuvv::xr
