#include "edit/project.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace neuvv {

namespace {

constexpr double kMaxRays = 1 << 26;  // of a projection
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// How far rays over a picture see: `dense` of them a pixel along each side.
struct DepthMap {
    uint32_t width = 0, height = 0, dense = 1;
    std::vector<float> distance_m;  // along the ray; infinite where nothing stops it
};

DepthMap depth_map(Picker& picker, const Camera& camera, uint32_t dense) {
    DepthMap map{camera.width * dense, camera.height * dense, dense, {}};
    map.distance_m.reserve(size_t{map.width} * map.height);
    constexpr uint32_t kRows = 64;
    std::vector<PickRay> rays;
    for (uint32_t first = 0; first < map.height; first += kRows) {
        rays.clear();
        for (uint32_t y = first; y < std::min(first + kRows, map.height); y++)
            for (uint32_t x = 0; x < map.width; x++)
                rays.push_back(pick_ray(camera, (glm::dvec2(x, y) + 0.5) / static_cast<double>(dense)));
        for (const Picked& picked : picker.pick(rays))
            map.distance_m.push_back(picked.hit() ? picked.distance_m : kInfinity);
    }
    return map;
}

// Rays a pixel along each side that lie no farther apart than the narrowest live leaf is wide.
uint32_t rays_a_pixel(Picker& picker, const Canvas& canvas, std::span<const float> sigma, const Camera& camera) {
    float edge = kInfinity;
    for (size_t leaf = 0; leaf < sigma.size(); leaf++)
        if (sigma[leaf] > 0) edge = std::min(edge, canvas.edges_m[leaf]);
    const DepthMap coarse = depth_map(picker, camera, 1);
    float nearest = kInfinity;
    for (const float distance : coarse.distance_m) nearest = std::min(nearest, distance);
    if (!std::isfinite(edge) || !std::isfinite(nearest)) return 1;
    const double pixel_m = double{nearest} / std::min(camera.fx, camera.fy);
    const double pixels = double{1} * camera.width * camera.height;
    const double most = std::clamp(std::floor(std::sqrt(kMaxRays / pixels)), 1.0, double{kMaxProjectionRays});
    return static_cast<uint32_t>(std::clamp(std::ceil(pixel_m / double{edge}), 1.0, most));
}

// Premultiplied linear colour and alpha between the middles of pixels.
glm::vec4 picture_at(const Image& image, glm::vec2 at) {
    const glm::vec2 size(image.width, image.height);
    const glm::vec2 place = glm::clamp(at - 0.5f, glm::vec2(0), size - 1.0f), low = glm::floor(place);
    const glm::vec2 part = place - low;
    const auto pixel = [&](float x, float y) {
        const auto column = static_cast<uint32_t>(std::min(x, size.x - 1)),
                   row = static_cast<uint32_t>(std::min(y, size.y - 1));
        const uint8_t* rgba = image.at(column, row);
        const float alpha = static_cast<float>(rgba[3]) / 255;
        return glm::vec4(alpha * glm::vec3(linear_from_srgb_byte(rgba[0]), linear_from_srgb_byte(rgba[1]),
                                           linear_from_srgb_byte(rgba[2])),
                         alpha);
    };
    return glm::mix(glm::mix(pixel(low.x, low.y), pixel(low.x + 1, low.y), part.x),
                    glm::mix(pixel(low.x, low.y + 1), pixel(low.x + 1, low.y + 1), part.x), part.y);
}

struct Projector {
    const Canvas& canvas;
    const Image& image;
    const Camera& camera;
    const DepthMap& map;
    glm::dmat4 camera_from_performer;

    // Whether the ray of a place in the picture meets a cube around the leaf's middle.
    bool meets(uint32_t leaf, glm::dvec2 place, double half_edge) const {
        const PickRay ray = pick_ray(camera, place);
        const glm::dvec3 to_middle = glm::dvec3(canvas.middles[leaf]) - glm::dvec3(ray.origin);
        double enter = 0, leave = double{kInfinity};
        for (int axis = 0; axis < 3; axis++) {
            const double inverse = 1 / double{ray.direction[axis]};
            const double a = (to_middle[axis] - half_edge) * inverse, b = (to_middle[axis] + half_edge) * inverse;
            enter = std::max(enter, std::min(a, b));
            leave = std::min(leave, std::max(a, b));
        }
        return enter <= leave;
    }

    // The mean of the picture at the rays that may pass through the leaf and come as far, premultiplied.
    glm::vec4 seen_at(uint32_t leaf) const {
        const glm::dvec3 at(camera_from_performer * glm::dvec4(canvas.middles[leaf], 1));
        if (!(at.z < 0)) return glm::vec4(0);
        const double dense = map.dense, edge = double{canvas.edges_m[leaf]},
                     half_diagonal = 0.5 * std::sqrt(3.0) * edge;
        const glm::dvec2 focal(camera.fx, camera.fy);
        const glm::dvec2 pixel(camera.cx + focal.x * at.x / -at.z, camera.cy - focal.y * at.y / -at.z);
        const glm::dvec2 half = half_diagonal / -at.z * focal * dense + 0.5;
        const glm::dvec2 low = glm::max(glm::ceil(pixel * dense - half - 0.5), 0.0);
        const glm::dvec2 high =
            glm::min(glm::floor(pixel * dense + half - 0.5), glm::dvec2(map.width, map.height) - 1.0);
        // Rays come to its nearest corner, or end as much before it as a slope falls between two rays.
        const double ray_m = glm::length(at) / (std::min(focal.x, focal.y) * dense);
        const double least = glm::length(at) - half_diagonal - ray_m;
        const bool narrow = edge / -at.z * std::max(focal.x, focal.y) < 1;  // than a pixel: the leaf's place counts
        // Rays that go on far beyond the leaf pass beside something solid, or through something soft: only those
        // through the leaf count, give or take half of what lies between two rays, so that paint does not go around an
        // outline.
        const double far = glm::length(at) + 4 * edge, half_edge = 0.5 * (edge + ray_m);
        glm::dvec4 sum(0);
        double count = 0;
        for (double y = low.y; y <= high.y; y++)
            for (double x = low.x; x <= high.x; x++) {
                const double ends = double{map.distance_m[static_cast<size_t>(y) * map.width + static_cast<size_t>(x)]};
                const glm::dvec2 ray = glm::dvec2(x, y) + 0.5;
                if (ends < least || (ends > far && !meets(leaf, ray / dense, half_edge))) continue;
                sum += glm::dvec4(picture_at(image, glm::vec2(narrow ? pixel : ray / dense)));
                count++;
            }
        return count > 0 ? glm::vec4(sum / count) : glm::vec4(0);
    }
};

}  // namespace

std::vector<LeafEdit> project(Picker& picker, const Canvas& canvas, std::span<const float> sigma, const Image& image,
                              const Camera& camera) {
    assert(camera.width == image.width && camera.height == image.height);
    const DepthMap map = depth_map(picker, camera, rays_a_pixel(picker, canvas, sigma, camera));
    const Projector projector{canvas, image, camera, map, glm::inverse(camera.world_from_camera)};
    std::vector<glm::vec4> seen(sigma.size());
    parallel_for(seen.size(), 1024, [&](size_t begin, size_t end) {
        for (size_t leaf = begin; leaf < end; leaf++)
            if (sigma[leaf] > 0) seen[leaf] = projector.seen_at(static_cast<uint32_t>(leaf));
    });
    std::vector<LeafEdit> edits;
    for (uint32_t leaf = 0; leaf < seen.size(); leaf++) {
        const float alpha = std::min(seen[leaf].a, 1.0f);
        if (alpha < 1.0f / 512) continue;
        edits.push_back({leaf, 0, 0, glm::clamp(glm::vec3(seen[leaf]) / alpha, 0.0f, 1.0f), alpha});
    }
    return edits;
}

}  // namespace neuvv
