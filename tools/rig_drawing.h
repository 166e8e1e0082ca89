// What `neuvv dataset` draws: a rig as an image, and names on images.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>

#include "media/image.h"
#include "training/rig.h"

namespace neuvv::tools {

using Colour = std::array<uint8_t, 3>;  // sRGB

// Draws capitals, digits and a few other characters, 8×10 pixels each with the gap to the next one; (x, y) is the top
// left corner in pixels. Small letters become capitals, anything else a question mark.
void draw_text(media::Image& image, int x, int y, const std::string& text, const Colour& colour);

// Every camera's frustum and name, and the scene's box. Cameras of `train` are blue, those of `test` orange, the box is
// black. Left: from above, x to the right, z down. Right: x to the right, y up. A bar shows how long a unit is.
media::Image draw_rig(const std::vector<training::RigCamera>& train, const std::vector<training::RigCamera>& test,
                      const std::optional<std::pair<glm::dvec3, glm::dvec3>>& box);

}  // namespace neuvv::tools
