// What `neuvv dataset` draws: a rig as an image.
#pragma once

#include <optional>
#include <utility>

#include "media/image.h"
#include "training/data/layouts/rig/rig.h"

namespace neuvv::tools {

// Every camera's frustum and name, and the scene's box. Cameras of `train` are blue, those of `test` orange, the box is
// black. Left: from above, x to the right, z down. Right: x to the right, y up. A bar shows how long a unit is.
media::Image draw_rig(const std::vector<training::RigCamera>& train, const std::vector<training::RigCamera>& test,
                      const std::optional<std::pair<glm::dvec3, glm::dvec3>>& box);

}  // namespace neuvv::tools
