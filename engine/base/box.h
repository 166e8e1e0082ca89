// Rays and boxes: which box a ray meets, and how a box stands on a floor.
#pragma once

#include <glm/glm.hpp>
#include <optional>

namespace neuvv {

// From `origin` on; `direction` is a unit vector.
struct Ray {
    glm::dvec3 origin{0}, direction{0, 0, -1};
};

// Its direction made one long; nothing where it is no ray: not finite, or without a direction.
std::optional<glm::dvec3> unit_direction(const Ray& ray);

// Metres along the ray to where it enters a box that stands in the world in any affine way: turned, scaled, sheared or
// mirrored. 0 from inside. Nothing where the ray misses it or leads away from it, where the matrix is not invertible or
// the box is empty (low > high in some axis; a flat box is not), and where the ray or the matrix is not finite.
std::optional<double> box_hit(const Ray& ray, const glm::dmat4& world_from_box, glm::dvec3 low, glm::dvec3 high);

// How far the lowest corner of its box stands above the floor; negative below it. NaN or infinite where there is none.
double above_floor(const glm::dmat4& world_from_node, glm::dvec3 low, glm::dvec3 high, double floor_y);

// Moved up or down by that, to stand on the floor. As it was where that is not finite.
glm::dmat4 on_floor(const glm::dmat4& world_from_node, glm::dvec3 low, glm::dvec3 high, double floor_y);

}  // namespace neuvv
