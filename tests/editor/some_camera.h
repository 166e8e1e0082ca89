// A camera whose axes are not parallel to those of the world.
#pragma once

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "stage/camera.h"

namespace neuvv::test {

// A camera 4 m from (0.2, 1, −0.3), turned by 0.7 about Y and by −0.4 about its own X.
inline stage::Camera some_camera() {
    glm::dmat4 world_from_camera = glm::translate(glm::dmat4(1), glm::dvec3(0.2, 1, -0.3));
    world_from_camera = glm::rotate(world_from_camera, 0.7, glm::dvec3(0, 1, 0));
    world_from_camera = glm::rotate(world_from_camera, -0.4, glm::dvec3(1, 0, 0));
    world_from_camera = glm::translate(world_from_camera, glm::dvec3(0, 0, 4));
    const double focal = 480 / (2 * std::tan(0.4));
    return {world_from_camera, focal, focal, 320, 240, 640, 480};
}

}  // namespace neuvv::test
