// Captures far from the origin, or of a size for which floats and weights are not made: they are moved and scaled when
// they are read.
#pragma once

#include <vector>

#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

// The frame in which these cameras are well placed: the capture's own, where they stand near its origin and measure
// some metres; else with an origin and a unit that are round numbers. `poses` are those of all cameras, whatever
// their split, so that all splits and segments have one frame.
voctree::WorldFrame world_of(const std::vector<glm::dmat4>& poses,
                             const std::optional<std::pair<glm::dvec3, glm::dvec3>>& box);

// Moves the rig's cameras and its box into world_of its poses, and says so.
void place_near_origin(Rig& rig);

}  // namespace neuvv::training
