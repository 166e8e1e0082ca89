// The camera that captures, training and rendering share.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace neuvv::stage {

// A pinhole camera. Pixel centres are at +0.5; x to the right, y down, in pixels.
struct Camera {
    glm::dmat4 world_from_camera{1};  // OpenGL axes: +X right, +Y up, looks along −Z
    double fx = 1, fy = 1, cx = 0, cy = 0;
    uint32_t width = 0, height = 0;
};

// The same view with `factor` times as many pixels along each side.
inline Camera enlarged(Camera camera, uint32_t factor) {
    for (double* length : {&camera.fx, &camera.fy, &camera.cx, &camera.cy}) *length *= factor;
    camera.width *= factor;
    camera.height *= factor;
    return camera;
}

}  // namespace neuvv::stage
