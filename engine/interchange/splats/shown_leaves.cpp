#include "interchange/splats/shown_leaves.h"

#include <cmath>
#include <limits>

#include "interchange/splats/splat_image.h"

namespace neuvv::interchange {

namespace {

constexpr uint32_t kSide_px = 256;
constexpr double kDistance = 4;  // in radii of the sphere around the leaves
constexpr int kDirections = 26;
// What hidden leaves count: other directions may show them, and they close what is half transparent.
constexpr float kShareOfAll = 0.1f;

stage::Camera camera_from(const glm::dvec3& direction, const glm::dvec3& centre, double radius) {
    const glm::dvec3 aside = std::abs(direction.y) > 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    const glm::dvec3 right = glm::normalize(glm::cross(aside, direction)), up = glm::cross(direction, right);
    stage::Camera camera;
    camera.world_from_camera = glm::dmat4(glm::dvec4(right, 0), glm::dvec4(up, 0), glm::dvec4(direction, 0),
                                          glm::dvec4(centre + kDistance * radius * direction, 1));
    camera.width = camera.height = kSide_px;
    camera.cx = camera.cy = 0.5 * kSide_px;
    camera.fx = camera.fy = 0.5 * kSide_px * std::sqrt(kDistance * kDistance - 1);
    return camera;
}

}  // namespace

void measure_shown(slice::Slice& volume) {
    const Splats splats = splats_of(volume, {});
    glm::dvec3 low(std::numeric_limits<double>::max()), high(std::numeric_limits<double>::lowest());
    for (const Splat& splat : splats.splats) {
        low = glm::min(low, glm::dvec3(splat.centre));
        high = glm::max(high, glm::dvec3(splat.centre));
    }
    const double radius = 0.5 * glm::distance(low, high) + double{volume.box_size.x} / (1u << volume.depth);
    std::vector<float> weights(splats.splats.size(), 0.0f);
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y)
            for (int z = -1; z <= 1; ++z)
                if (x != 0 || y != 0 || z != 0)
                    add_weights(splats, camera_from(glm::normalize(glm::dvec3(x, y, z)), 0.5 * (low + high), radius),
                                weights);
    const double pixel_m = 2 * radius / kSide_px;
    const auto unit = static_cast<float>(pixel_m * pixel_m / kDirections);
    for (size_t i = 0; i < weights.size(); ++i)
        volume.leaves[i].shown = kShareOfAll * volume.leaves[i].shown + unit * weights[i];
}

}  // namespace neuvv::interchange
