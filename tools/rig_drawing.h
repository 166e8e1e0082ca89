// A rig as an image: every camera's frustum and name, and the scene's box, from above and from the side.
#pragma once

#include <optional>
#include <utility>

#include "media/image.h"
#include "training/rig.h"

namespace neuvv::tools {

// Cameras of `train` are blue, those of `test` orange, the box is black. Left: from above, x to the right, z down.
// Right: x to the right, y up. A bar says how long a unit is.
media::Image draw_rig(const std::vector<training::RigCamera>& train, const std::vector<training::RigCamera>& test,
                      const std::optional<std::pair<glm::dvec3, glm::dvec3>>& box);

}  // namespace neuvv::tools
