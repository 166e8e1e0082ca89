// A node's transform as the numbers that users type: position, angles, scale.
#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>

#include "edit/operations.h"
#include "stage/evaluated_stage.h"

namespace neuvv::viewer {

// The angles, in degrees, of the rotations about the parent's X, then Y, then Z (as Placement::turn_deg); Y is from −90
// to 90.
glm::dvec3 angles_of(const glm::dquat& rotation);
glm::dquat rotation_of(const glm::dvec3& angles_deg);
// `displayed_deg`, where these angles mean this rotation; else angles_of(rotation). Fields thus do not jump to other
// angles for the same rotation.
glm::dvec3 angles_like(const glm::dvec3& displayed_deg, const glm::dquat& rotation);

// The argument of place_node that takes a node from one transform to another. A scale of 0 stays 0.
edit::Placement placement_to(const edit::NodeTransform& from, const edit::NodeTransform& to);

// `scale`, where each changed component keeps the sign that it had in `before` and a size of at least kMinScale, so
// that the change can be reversed.
constexpr double kMinScale = 1e-3;
glm::dvec3 nonzero_scale(const glm::dvec3& scale, const glm::dvec3& before);

// The move, in the space of its parent, after which the lowest point of a node and of its descendants is at y = 0 of
// the world. Counted are the vertices of meshes and the boxes of performers. Of a box that contains y = 0 of its own
// space, only the part above counts, because y = 0 is the floor on which the performer was captured. Nullopt where
// there are neither meshes nor performers, or where the parent's transform is flat.
std::optional<glm::dvec3> move_to_floor(const stage::Stage& stage, const stage::EvaluatedStage& evaluated,
                                        uint32_t node);

}  // namespace neuvv::viewer
