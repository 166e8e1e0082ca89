// Rays and boxes: where a ray enters a box, and how a box stands on a floor.
#pragma once

#include <glm/glm.hpp>
#include <optional>

namespace neuvv {

// A ray that starts at `origin`; `direction` is a unit vector.
struct Ray {
    glm::dvec3 origin{0}, direction{0, 0, -1};
};

// The ray's direction, normalised; nullopt where the ray is not finite or has no direction.
std::optional<glm::dvec3> unit_direction(const Ray& ray);

// The distance in metres along the ray at which it enters a box with any affine transform: turned, scaled, sheared or
// mirrored. 0 where the ray starts inside. Nullopt where the ray misses the box or points away from it, where the
// matrix is not invertible or the box is empty (low > high in some axis; a flat box is not empty), and where the ray or
// the matrix is not finite.
std::optional<double> box_hit(const Ray& ray, const glm::dmat4& world_from_box, glm::dvec3 low, glm::dvec3 high);

// The height in metres of a box's lowest corner above the floor; negative below it. NaN or infinite where that is not
// finite.
double above_floor(const glm::dmat4& world_from_node, glm::dvec3 low, glm::dvec3 high, double floor_y);

// The transform moved up or down so that the box stands on the floor; unchanged where the height is not finite.
glm::dmat4 on_floor(const glm::dmat4& world_from_node, glm::dvec3 low, glm::dvec3 high, double floor_y);

}  // namespace neuvv
