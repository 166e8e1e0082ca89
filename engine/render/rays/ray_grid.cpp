#include "render/rays/ray_grid.h"

#include <algorithm>
#include <cmath>

namespace neuvv::render {

namespace {

struct AxisRays {
    GridAxis axis{};
    uint32_t rays = 0;
};

// Divides an axis into whole pixels before, inside and beyond the inset, with a whole number of rays for each part.
AxisRays axis_of(uint32_t pixels, double scale, double first, double last, double beside) {
    const double size = pixels;
    const double begin = std::round(std::clamp(first, 0.0, 1.0) * (size - 1));
    const double end = std::clamp(std::round(last * size), begin + 1, size);
    const double ray_begin = std::ceil(begin * scale * beside);
    const double ray_end = ray_begin + std::ceil((end - begin) * scale);
    const double rays_beyond = std::ceil((size - end) * scale * beside);
    const auto slope = [](double length, double rays) { return static_cast<float>(rays > 0 ? length / rays : 1); };
    AxisRays result;
    result.axis.knots = glm::vec4(glm::dvec4(ray_begin, ray_end, begin, end));
    result.axis.slopes = {slope(begin, ray_begin), slope(end - begin, ray_end - ray_begin),
                          slope(size - end, rays_beyond), 0};
    result.rays = static_cast<uint32_t>(ray_end + rays_beyond);
    return result;
}

}  // namespace

RayGrid ray_grid(uint32_t width, uint32_t height, double scale, const Fovea& fovea) {
    const AxisRays x = axis_of(width, scale, fovea.first.x, fovea.last.x, fovea.beside);
    const AxisRays y = axis_of(height, scale, fovea.first.y, fovea.last.y, fovea.beside);
    return {x.axis, y.axis, {x.rays, y.rays}};
}

double pixel_of_ray(const GridAxis& axis, double ray) {
    const glm::dvec4 k(axis.knots);
    const glm::dvec4 slopes(axis.slopes);
    if (ray < k.x) return k.z + (ray - k.x) * slopes.x;
    return ray <= k.y ? k.z + (ray - k.x) * slopes.y : k.w + (ray - k.y) * slopes.z;
}

double ray_of_pixel(const GridAxis& axis, double pixel) {
    const glm::dvec4 k(axis.knots);
    const glm::dvec4 slopes(axis.slopes);
    if (pixel < k.z) return k.x + (pixel - k.z) / slopes.x;
    return pixel <= k.w ? k.x + (pixel - k.z) / slopes.y : k.y + (pixel - k.w) / slopes.z;
}

ShaderCamera shader_camera(const stage::Camera& camera, const RayGrid& grid) {
    ShaderCamera shader = shader_camera(camera);
    shader.right.w = static_cast<float>(grid.rays.x);
    shader.down.w = static_cast<float>(grid.rays.y);
    shader.across = grid.across;
    shader.downwards = grid.downwards;
    return shader;
}

}  // namespace neuvv::render
