// Cameras' poses in JSON that other programs wrote (base/json.h).
#pragma once

#include <glm/glm.hpp>

#include "base/json.h"

namespace neuvv::training {

// A camera's pose in rows, 4×4 or 3×4: rigid, right-handed, not out of this world. Throws InputError.
glm::dmat4 json_pose(const JsonNode& node);
void expect_rigid(const JsonNode& node, const glm::dmat4& pose);

// (x, y, z) → (x, z, −y)
inline const glm::dmat3 kYUpFromZUp(1, 0, 0, 0, 0, -1, 0, 1, 0);

constexpr double kMaxDistance_m = 1e6;  // beyond it, floats no longer resolve a performer

}  // namespace neuvv::training
