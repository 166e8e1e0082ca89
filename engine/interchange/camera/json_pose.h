// Poses of cameras in JSON that other programs wrote (base/formats/json.h).
#pragma once

#include <glm/glm.hpp>

#include "base/formats/json.h"

namespace neuvv::interchange {

// A camera's pose, 4×4 or 3×4 numbers row by row. Throws InputError where it does not end with 0 0 0 1 or where
// expect_rigid does.
glm::dmat4 json_pose(const JsonNode& node);
// Throws InputError for a pose that is scaled, sheared, left-handed, or more than kMaxDistance_m from the origin.
void expect_rigid(const JsonNode& node, const glm::dmat4& pose);

// Turns a world with +Z up into one with +Y up: (x, y, z) → (x, z, −y).
inline const glm::dmat3 kYUpFromZUp(1, 0, 0, 0, 0, -1, 0, 1, 0);
// Turns a world with −Y up, as that of CMU's Panoptic Studio: (x, y, z) → (x, −y, −z).
inline const glm::dmat3 kYUpFromYDown(1, 0, 0, 0, -1, 0, 0, 0, -1);

constexpr double kUnitTolerance = 1e-2;  // of a quaternion's length; some files have three decimals
// Northings of UTM have 7 digits, also in feet. Much further away, files do not write a camera's place to a millimetre.
constexpr double kMaxDistance_m = 1e8;

}  // namespace neuvv::interchange
