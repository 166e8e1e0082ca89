// Where the panel is.
#pragma once

#include "xr/pose.h"

namespace neuvv::headset {

constexpr glm::dvec2 kPanel_m{0.72, 0.54}, kWristPanel_m{0.36, 0.27};
struct PanelPlacement {
    xr::Pose world_from_panel;  // the origin is the panel's middle; X to its right, Y to its top
    glm::dvec2 size_m = kPanel_m;

    // The world position of a point of the panel, which is given as 0..1 from the upper left.
    glm::dvec3 point_at(glm::dvec2 uv) const {
        return world_from_panel * glm::dvec3((uv.x - 0.5) * size_m.x, (0.5 - uv.y) * size_m.y, 0);
    }
};

}  // namespace neuvv::headset
