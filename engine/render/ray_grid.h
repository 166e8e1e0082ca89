// Where the rays of an image stand: one a pixel, or fewer, of which an inset has more than what is beside it
// (foveation).
#pragma once

#include "render/trace.h"

namespace neuvv::render {

// The part of an image that is looked at, in shares of its width and height from the top left, and how many rays along
// each side stand beside it for one inside it.
struct Fovea {
    glm::dvec2 first{0}, last{1};
    double beside = 1;  // above 0, at most 1
    bool operator==(const Fovea&) const = default;
};

struct RayGrid {
    GridAxis across, downwards;
    glm::uvec2 rays{0};
};

// `scale`: rays a pixel along each side, inside the inset; above 0, at most 1. At 1 and without an inset rays stand at
// pixels' centres.
RayGrid ray_grid(uint32_t width, uint32_t height, double scale = 1, const Fovea& fovea = {});

// The pixel (from 0, fractions allowed) at which a ray's place lies: the twin of grid.glsl.
double pixel_of_ray(const GridAxis& axis, double ray);
double ray_of_pixel(const GridAxis& axis, double pixel);

// `camera` is that of the image; its rays stand where the grid says.
ShaderCamera shader_camera(const stage::Camera& camera, const RayGrid& grid);

}  // namespace neuvv::render
