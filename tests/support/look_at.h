// Cameras for tests.
#pragma once

#include <cmath>
#include <glm/glm.hpp>

#include "stage/camera.h"

namespace neuvv::test {

// A camera at `eye` that looks at `target`, world +Y up; `focal` is the focal length divided by the image's width.
inline stage::Camera look_at(glm::dvec3 eye, glm::dvec3 target, uint32_t width, uint32_t height, double focal = 1.0) {
    const glm::dvec3 back = glm::normalize(eye - target);
    const glm::dvec3 right = glm::normalize(glm::cross(glm::dvec3(0, 1, 0), back));
    stage::Camera camera;
    camera.world_from_camera = glm::dmat4(glm::dvec4(right, 0), glm::dvec4(glm::cross(back, right), 0),
                                          glm::dvec4(back, 0), glm::dvec4(eye, 1));
    camera.fx = camera.fy = focal * width;
    camera.cx = width / 2.0;
    camera.cy = height / 2.0;
    camera.width = width;
    camera.height = height;
    return camera;
}

}  // namespace neuvv::test
