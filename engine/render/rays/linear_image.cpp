#include "render/rays/linear_image.h"

#include <cassert>
#include <cmath>
#include <limits>

namespace neuvv::render {

float axis_per_ray(const stage::Camera& rays, glm::uvec2 ray) {
    const glm::dvec2 at = (glm::dvec2(ray) + 0.5 - glm::dvec2(rays.cx, rays.cy)) / glm::dvec2(rays.fx, rays.fy);
    return static_cast<float>(1 / glm::length(glm::dvec3(at, 1)));
}

media::LinearImage linear_image(std::span<const glm::vec4> radiance, std::span<const float> depth,
                                const stage::Camera& camera, uint32_t samples, const glm::vec4& background) {
    const uint32_t width = camera.width, height = camera.height;
    const stage::Camera rays = stage::enlarged(camera, samples);
    const size_t row = size_t{samples} * width;
    assert(radiance.size() == row * samples * height && depth.size() == radiance.size());
    media::LinearImage image{width, height};
    image.rgba.resize(size_t{4} * width * height);
    image.depth_m.resize(size_t{width} * height);
    const glm::vec4 behind(glm::vec3(background) * background.a, background.a);
    for (size_t y = 0; y < height; ++y)
        for (size_t x = 0; x < width; ++x) {
            glm::vec4 light(0);
            float metres = 0, weight = 0;
            for (size_t i = 0; i < size_t{samples} * samples; ++i) {
                const size_t ray = (samples * y + i / samples) * row + samples * x + i % samples;
                light += radiance[ray];
                if (!(radiance[ray].a > 0) || std::isinf(depth[ray])) continue;  // a background has no depth
                const glm::uvec2 at(ray % row, ray / row);
                metres += radiance[ray].a * axis_per_ray(rays, at) * depth[ray];
                weight += radiance[ray].a;
            }
            const size_t pixel = y * width + x;
            image.depth_m[pixel] = weight > 0 ? metres / weight : std::numeric_limits<float>::infinity();
            light /= static_cast<float>(samples * samples);
            light += (1 - light.a) * behind;
            for (int c = 0; c < 4; ++c) image.rgba[4 * pixel + static_cast<size_t>(c)] = light[c];
        }
    return image;
}

}  // namespace neuvv::render
