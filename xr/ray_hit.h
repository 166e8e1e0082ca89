// Where a pointing ray meets a flat panel.
#pragma once

#include <optional>

#include "xr/pose.h"

namespace neuvv::xr {

struct RectangleHit {
    glm::dvec2 at{0};   // 0 to 1: to the right and down from the upper left corner
    double metres = 0;  // along the ray
};
// A panel with its middle at the pose's origin, X to its right, Y to its top; it is seen from its +Z side alone.
std::optional<RectangleHit> rectangle_hit(const Ray& ray, const Pose& world_from_rectangle, glm::dvec2 size_m);

}  // namespace neuvv::xr
