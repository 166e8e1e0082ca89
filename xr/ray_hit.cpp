#include "xr/ray_hit.h"

namespace neuvv::xr {

std::optional<RectangleHit> rectangle_hit(const Ray& ray, const Pose& world_from_rectangle, glm::dvec2 size_m) {
    const std::optional<glm::dvec3> along = unit_direction(ray);
    if (!along || !is_sound(world_from_rectangle) || !(size_m.x > 0) || !(size_m.y > 0)) return {};
    const Pose rectangle_from_world = inverse(world_from_rectangle);
    const glm::dvec3 origin = rectangle_from_world * ray.origin, direction = rectangle_from_world.rotation * *along;
    if (origin.z < 0 || direction.z >= 0) return {};
    const double metres = origin.z / -direction.z;
    const glm::dvec3 there = origin + direction * metres;
    const glm::dvec2 at(0.5 + there.x / size_m.x, 0.5 - there.y / size_m.y);
    if (!(at.x >= 0 && at.x <= 1 && at.y >= 0 && at.y <= 1)) return {};
    return RectangleHit{.at = at, .metres = metres};
}

}  // namespace neuvv::xr
