// Where a pointer ray meets a flat panel.
#pragma once

#include <optional>

#include "xr/pose.h"

namespace neuvv::xr {

struct RectangleHit {
    glm::dvec2 uv{0};       // 0..1, to the right and down from the upper left corner
    double distance_m = 0;  // along the ray
};
// The rectangle's centre is at the pose's origin, X to its right and Y to its top. A ray hits it only from its +Z side.
// Empty where the ray misses, or where an argument is not valid: a ray without a direction, a pose that is not
// (is_valid), a size that is not positive.
std::optional<RectangleHit> rectangle_hit(const Ray& ray, const Pose& world_from_rectangle, glm::dvec2 size_m);

}  // namespace neuvv::xr
