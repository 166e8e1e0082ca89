// What is seen at a place of the picture.
#pragma once

#include <optional>

#include "tools/viewer/drawer.h"

namespace neuvv::viewer {

struct Seen {
    std::optional<uint32_t> node;  // of a performer or of a piece of the set
    std::optional<glm::dvec3> at;  // world: where
};

// Of the performers whose boxes the ray meets, the nearest whose alpha there is at least a half, the set before it
// counted; else the set's nearest triangle. `pixel` as cameras count. A task of the drawer: it draws a pixel for each
// of those boxes.
Seen seen_at(OnDevice& on_device, const stage::StageInstant& instant, const stage::Camera& camera, glm::dvec2 pixel);

}  // namespace neuvv::viewer
