#include "edit/project.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "base/threads/parallel.h"

namespace neuvv::edit {

namespace {

constexpr double kMaxRays = 1 << 26;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

// The distances at which rays over an image end, with rays_per_side rays per pixel side.
struct DepthMap {
    uint32_t width = 0, height = 0, rays_per_side = 1;
    std::vector<float> distance_m;  // along the ray; infinite where the ray meets nothing

    glm::dvec2 pixel(uint32_t x, uint32_t y) const {
        return (glm::dvec2(x, y) + 0.5) / static_cast<double>(rays_per_side);
    }
};

DepthMap depth_map(render::Picker& picker, const stage::Camera& camera, uint32_t rays_per_side) {
    DepthMap map{camera.width * rays_per_side, camera.height * rays_per_side, rays_per_side, {}};
    map.distance_m.reserve(size_t{map.width} * map.height);
    constexpr uint32_t kRows = 64;
    std::vector<PickRay> rays;
    for (uint32_t first = 0; first < map.height; first += kRows) {
        rays.clear();
        for (uint32_t y = first; y < std::min(first + kRows, map.height); ++y)
            for (uint32_t x = 0; x < map.width; ++x) rays.push_back(render::pick_ray(camera, map.pixel(x, y)));
        for (const render::Picked& picked : picker.pick(rays))
            map.distance_m.push_back(picked.hit() ? picked.distance_m : kInfinity);
    }
    return map;
}

// The vector from the eye to what a pixel shows at a depth of one metre along the camera's own axis. Its length is in
// the performer's metres: as the camera sees it, that space may be stretched, sheared or mirrored.
glm::dvec3 view_line(const stage::Camera& camera, glm::dvec2 pixel) {
    const glm::dvec3 line((pixel.x - camera.cx) / camera.fx, (camera.cy - pixel.y) / camera.fy, -1);
    return glm::dmat3(camera.world_from_camera) * line;
}

// The spacing of neighbouring rays across their direction, in the performer's metres, at a depth of one metre along the
// camera's own axis.
struct RayCell {
    double side = 0;           // to the next ray, across or down, the larger of the two
    double half_diagonal = 0;  // the largest distance from a point to its nearest ray
};

RayCell ray_cell(const stage::Camera& camera, const glm::dvec3& direction) {
    const auto aside = [&](const glm::dvec4& step) {
        return glm::dvec3(step) - glm::dot(glm::dvec3(step), direction) * direction;
    };
    const glm::dvec3 across = aside(camera.world_from_camera[0]) / camera.fx,
                     down = aside(camera.world_from_camera[1]) / camera.fy;
    return {std::max(glm::length(across), glm::length(down)),
            0.5 * std::max(glm::length(across + down), glm::length(across - down))};
}

// The number of rays per pixel side with which neighbouring rays are no farther apart than the narrowest live leaf is
// wide.
uint32_t rays_per_pixel_side(render::Picker& picker, const Canvas& canvas, std::span<const float> sigma,
                             const stage::Camera& camera) {
    float edge = kInfinity;
    for (size_t leaf = 0; leaf < sigma.size(); ++leaf)
        if (sigma[leaf] > 0) edge = std::min(edge, canvas.edges_m[leaf]);
    const DepthMap coarse = depth_map(picker, camera, 1);
    double pixel_m = INFINITY;  // the smallest spacing of pixels at the surface
    for (uint32_t y = 0; y < coarse.height; ++y)
        for (uint32_t x = 0; x < coarse.width; ++x) {
            const double distance = double{coarse.distance_m[size_t{y} * coarse.width + x]};
            if (distance == double{kInfinity}) continue;
            const glm::dvec3 line = view_line(camera, coarse.pixel(x, y));
            const double depth = distance / glm::length(line);
            pixel_m = std::min(pixel_m, depth * ray_cell(camera, glm::normalize(line)).side);
        }
    if (!std::isfinite(edge) || !std::isfinite(pixel_m)) return 1;
    const double pixels = double{1} * camera.width * camera.height;
    const double max_side = std::clamp(std::floor(std::sqrt(kMaxRays / pixels)), 1.0, double{kMaxProjectionRays});
    return static_cast<uint32_t>(std::clamp(std::ceil(pixel_m / double{edge}), 1.0, max_side));
}

// Premultiplied linear colour and alpha at a point of the image, interpolated between the centres of pixels.
glm::vec4 image_at(const media::Image& image, glm::vec2 at) {
    const glm::vec2 size(image.width, image.height);
    const glm::vec2 texel = glm::clamp(at - 0.5f, glm::vec2(0), size - 1.0f), low = glm::floor(texel);
    const glm::vec2 part = texel - low;
    const auto pixel = [&](float x, float y) {
        const auto column = static_cast<uint32_t>(std::min(x, size.x - 1)),
                   row = static_cast<uint32_t>(std::min(y, size.y - 1));
        const uint8_t* rgba = image.at(column, row);
        const float alpha = static_cast<float>(rgba[3]) / 255;
        return glm::vec4(alpha * glm::vec3(media::linear_from_srgb_byte(rgba[0]), media::linear_from_srgb_byte(rgba[1]),
                                           media::linear_from_srgb_byte(rgba[2])),
                         alpha);
    };
    return glm::mix(glm::mix(pixel(low.x, low.y), pixel(low.x + 1, low.y), part.x),
                    glm::mix(pixel(low.x, low.y + 1), pixel(low.x + 1, low.y + 1), part.x), part.y);
}

// Looks up the image for leaves. All lengths are in the performer's metres, in which leaves are cubes and picked
// distances are measured.
struct Projector {
    Projector(const Canvas& on, const media::Image& of, const stage::Camera& from, const DepthMap& depths)
        : canvas(on),
          image(of),
          camera(from),
          map(depths),
          camera_from_performer(glm::inverse(camera.world_from_camera)),
          eye(camera.world_from_camera[3]) {}
    const Canvas& canvas;
    const media::Image& image;
    const stage::Camera& camera;
    const DepthMap& map;
    glm::dmat4 camera_from_performer;
    glm::dvec3 eye;

    // A leaf as it lies in the image.
    struct Footprint {
        glm::dvec2 pixel;         // where its centre appears
        glm::dvec2 pixels_per_m;  // across and down, for a metre in the direction in which it appears longest
        glm::dvec3 to_centre;     // from the eye, metres
        double edge;              // metres
        RayCell rays;             // at the leaf's depth
    };
    Footprint footprint(uint32_t leaf, const glm::dvec3& at_camera) const {
        const double depth = -at_camera.z;
        const glm::dvec2 line = glm::dvec2(at_camera) / depth, focal(camera.fx, camera.fy);
        // How far a step in the performer moves the image point: the derivatives of the pixel, as one row of the matrix
        // per image axis.
        const glm::dmat3 rows = glm::transpose(glm::dmat3(camera_from_performer));
        const glm::dvec2 slope(glm::length(rows[0] + line.x * rows[2]), glm::length(rows[1] + line.y * rows[2]));
        const glm::dvec3 to_centre = glm::dvec3(canvas.centres[leaf]) - eye;
        RayCell rays = ray_cell(camera, glm::normalize(to_centre));
        for (double* length : {&rays.side, &rays.half_diagonal}) *length *= depth / map.rays_per_side;
        return {glm::dvec2(camera.cx, camera.cy) + focal * glm::dvec2(line.x, -line.y), focal * slope / depth,
                to_centre, double{canvas.edges_m[leaf]}, rays};
    }

    // Whether a ray meets a cube around the leaf's centre.
    static bool meets(const Footprint& leaf, const glm::dvec3& direction, double half_edge) {
        double enter = 0, leave = double{kInfinity};
        for (int axis = 0; axis < 3; ++axis) {
            const double inverse = 1 / direction[axis];
            const double a = (leaf.to_centre[axis] - half_edge) * inverse,
                         b = (leaf.to_centre[axis] + half_edge) * inverse;
            enter = std::max(enter, std::min(a, b));
            leave = std::min(leave, std::max(a, b));
        }
        return enter <= leave;
    }

    // Whether the ray of a pixel, which ends at ray_end_m, counts for the leaf: it must pass through the leaf and reach
    // as far.
    bool counts(const Footprint& leaf, glm::dvec2 pixel, double ray_end_m) const {
        const double half_diagonal = 0.5 * std::sqrt(3.0) * leaf.edge, distance = glm::length(leaf.to_centre);
        // The ray must reach the leaf's nearest corner. It may end earlier by as much as a slope falls between two
        // rays.
        if (ray_end_m < distance - half_diagonal - leaf.rays.side) return false;
        // The ray must pass through the ball around the leaf, or be the nearest one where rays are farther apart than
        // that.
        const glm::dvec3 direction = glm::normalize(view_line(camera, pixel));
        const double aside = glm::length(glm::cross(direction, leaf.to_centre));
        if (aside > half_diagonal + leaf.rays.half_diagonal) return false;
        // A ray that goes on far beyond the leaf passes beside a solid surface or through a soft one. Only rays through
        // the leaf count then, with a tolerance of half the spacing of rays, so that paint does not spread around an
        // outline.
        return ray_end_m <= distance + 4 * leaf.edge || meets(leaf, direction, 0.5 * (leaf.edge + leaf.rays.side));
    }

    // The mean of the image at the rays that count for the leaf, premultiplied.
    glm::vec4 colour_of(uint32_t index) const {
        const glm::dvec3 at(camera_from_performer * glm::dvec4(canvas.centres[index], 1));
        if (!(at.z < 0)) return glm::vec4(0);
        const Footprint leaf = footprint(index, at);
        const glm::dvec2 centre = leaf.pixel * static_cast<double>(map.rays_per_side) - 0.5;
        const glm::dvec2 half =
            0.5 * std::sqrt(3.0) * leaf.edge * leaf.pixels_per_m * static_cast<double>(map.rays_per_side) + 0.5;
        const glm::dvec2 low = glm::max(glm::ceil(centre - half), 0.0);
        const glm::dvec2 high = glm::min(glm::floor(centre + half), glm::dvec2(map.width, map.height) - 1.0);
        // A leaf that is narrower than a pixel takes the colour at its own point of the image.
        const bool narrow = leaf.edge * std::max(leaf.pixels_per_m.x, leaf.pixels_per_m.y) < 1;
        glm::dvec4 sum(0);
        double count = 0;
        for (double y = low.y; y <= high.y; ++y)
            for (double x = low.x; x <= high.x; ++x) {
                const auto column = static_cast<uint32_t>(x), row = static_cast<uint32_t>(y);
                const glm::dvec2 pixel = map.pixel(column, row);
                if (!counts(leaf, pixel, double{map.distance_m[size_t{row} * map.width + column]})) continue;
                sum += glm::dvec4(image_at(image, glm::vec2(narrow ? leaf.pixel : pixel)));
                ++count;
            }
        return count > 0 ? glm::vec4(sum / count) : glm::vec4(0);
    }
};

}  // namespace

std::vector<voctree::LeafEdit> project(render::Picker& picker, const Canvas& canvas, std::span<const float> sigma,
                                       const media::Image& image, const stage::Camera& camera) {
    assert(camera.width == image.width && camera.height == image.height);
    const DepthMap map = depth_map(picker, camera, rays_per_pixel_side(picker, canvas, sigma, camera));
    const Projector projector(canvas, image, camera, map);
    std::vector<glm::vec4> colours(sigma.size());
    parallel_for(colours.size(), 1024, [&](size_t begin, size_t end) {
        for (size_t leaf = begin; leaf < end; ++leaf)
            if (sigma[leaf] > 0) colours[leaf] = projector.colour_of(static_cast<uint32_t>(leaf));
    });
    std::vector<voctree::LeafEdit> edits;
    for (uint32_t leaf = 0; leaf < colours.size(); ++leaf) {
        const float alpha = std::min(colours[leaf].a, 1.0f);
        if (alpha < 1.0f / 512) continue;
        edits.push_back({leaf, 0, 0, glm::clamp(glm::vec3(colours[leaf]) / alpha, 0.0f, 1.0f), alpha});
    }
    return edits;
}

}  // namespace neuvv::edit
