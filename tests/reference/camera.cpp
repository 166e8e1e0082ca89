#include "reference/camera.h"

namespace neuvv::reference {

Ray camera_ray(const stage::Camera& camera, double px, double py) {
    // Pixels count y downwards, OpenGL's camera axes upwards.
    const glm::dvec3 in_camera{(px + 0.5 - camera.cx) / camera.fx, -(py + 0.5 - camera.cy) / camera.fy, -1.0};
    Ray ray;
    ray.origin = glm::dvec3(camera.world_from_camera[3]);
    ray.direction = glm::normalize(glm::dmat3(camera.world_from_camera) * in_camera);
    return ray;
}

}  // namespace neuvv::reference
