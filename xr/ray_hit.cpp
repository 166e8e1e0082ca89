#include "xr/ray_hit.h"

namespace neuvv::xr {

std::optional<RectangleHit> rectangle_hit(const Ray& ray, const Pose& world_from_rectangle, glm::dvec2 size_m) {
    const std::optional<glm::dvec3> along = unit_direction(ray);
    if (!along || !is_valid(world_from_rectangle) || !(size_m.x > 0) || !(size_m.y > 0)) return {};
    const Pose rectangle_from_world = inverse(world_from_rectangle);
    const glm::dvec3 origin = rectangle_from_world * ray.origin, direction = rectangle_from_world.rotation * *along;
    if (origin.z < 0 || direction.z >= 0) return {};
    const double distance_m = origin.z / -direction.z;
    const glm::dvec3 hit = origin + direction * distance_m;
    const glm::dvec2 uv(0.5 + hit.x / size_m.x, 0.5 - hit.y / size_m.y);
    if (!(uv.x >= 0 && uv.x <= 1 && uv.y >= 0 && uv.y <= 1)) return {};
    return RectangleHit{.uv = uv, .distance_m = distance_m};
}

}  // namespace neuvv::xr
