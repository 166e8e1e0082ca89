// The positions of rays in an image: one per pixel, or fewer; an inset may have more rays than the rest (foveation).
#pragma once

#include "render/rays/ray_batch.h"

namespace neuvv::render {

// The inset: the part of an image that the viewer looks at. Its corners are fractions of the image's width and height,
// from the upper left. `beside` is the density of rays beside the inset along each axis, relative to the density
// inside.
struct Fovea {
    glm::dvec2 first{0}, last{1};
    double beside = 1;  // above 0, at most 1
    bool operator==(const Fovea&) const = default;
};

struct RayGrid {
    GridAxis across, downwards;  // from rays to pixels (shared/trace.h)
    glm::uvec2 rays{0};          // their numbers along both axes
};

// `scale`: rays per pixel along each axis inside the inset; above 0, at most 1. At 1 and without an inset, rays go
// through the centres of pixels.
RayGrid ray_grid(uint32_t width, uint32_t height, double scale = 1, const Fovea& fovea = {});

// The position along an axis in pixels (from 0, with fractions) of a position in rays, as grid.glsl computes it, and
// the inverse.
double pixel_of_ray(const GridAxis& axis, double ray);
double ray_of_pixel(const GridAxis& axis, double pixel);

// `camera` is the image's camera; the rays have the positions of the grid.
ShaderCamera shader_camera(const stage::Camera& camera, const RayGrid& grid);

}  // namespace neuvv::render
