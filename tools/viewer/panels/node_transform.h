// A node's transform in numbers that people type: where it stands, turned by angles, scaled.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>

#include "edit/operations.h"
#include "stage/evaluated_stage.h"

namespace neuvv::viewer {

// Degrees about the parent's X, then Y, then Z, as Placement::turn_deg; Y from −90 to 90.
glm::dvec3 angles_of(const glm::dquat& rotation);
glm::dquat rotation_of(const glm::dvec3& angles_deg);
// The angles that were shown as long as they mean this rotation, so that fields do not jump to others that mean the
// same.
glm::dvec3 angles_like(const glm::dvec3& displayed_deg, const glm::dquat& rotation);

// For place_node: what brings a node from one transform to another. A scale of 0 stays.
edit::Placement placement_to(const edit::NodeTransform& from, const edit::NodeTransform& to);

// Scales keep their icon, and enough length to be undone.
constexpr double kMinScale = 1e-3;
glm::dvec3 nonzero_scale(const glm::dvec3& scale, const glm::dvec3& before);

// How a node must be moved in its parent's space for the lowest of it, and of all that hangs on it, to stand at y = 0
// of the world. Of meshes, their vertices; of performers, their boxes from y = 0 upwards, which is the floor that they
// were captured on: boxes reach below it. Nothing where it has neither, or its parent is flat.
std::optional<glm::dvec3> move_to_floor(const stage::Stage& stage, const stage::EvaluatedStage& evaluated,
                                        uint32_t node);

}  // namespace neuvv::viewer
