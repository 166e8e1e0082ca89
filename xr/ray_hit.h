// What a pointing ray meets: boxes and flat panels.
#pragma once

#include <optional>

#include "xr/pose.h"

namespace neuvv::xr {

// Metres along the ray to where it enters a box that stands in the world in any affine way: turned, scaled, sheared or
// mirrored. 0 from inside. Nothing where the ray misses it or leads away from it, where the matrix is not invertible or
// the box is empty (low > high in some axis; a flat box is not), and where the ray or the matrix is not finite.
std::optional<double> box_hit(const Ray& ray, const glm::dmat4& world_from_box, glm::dvec3 low, glm::dvec3 high);

struct RectangleHit {
    glm::dvec2 at{0};   // 0 to 1: to the right and down from the upper left corner
    double metres = 0;  // along the ray
};
// A panel with its middle at the pose's origin, X to its right, Y to its top; it is seen from its +Z side alone.
std::optional<RectangleHit> rectangle_hit(const Ray& ray, const Pose& world_from_rectangle, glm::dvec2 size_m);

}  // namespace neuvv::xr
