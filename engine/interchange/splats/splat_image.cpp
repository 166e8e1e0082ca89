#include "interchange/splats/splat_image.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>

#include "base/threads/parallel.h"

namespace neuvv::interchange {

namespace {

constexpr float kNear_m = 0.01f, kWidening_px2 = 0.3f, kLeastAlpha = 1 / 255.0f, kMostOpacity = 0.99f;
constexpr uint32_t kRowsOfPart = 16;

struct Footprint {
    size_t splat;
    float depth;
    glm::vec2 centre;  // pixels
    float a, b, c;     // of the inverse covariance: a x² + 2 b x y + c y²
    float reach;       // pixels along y at which nothing is left
    float reach_x, opacity;
    glm::vec3 colour;
};

// Y_lm with the Condon-Shortley phase.
glm::vec3 colour_at(const SplatColour& k, uint32_t degree, const glm::vec3& d) {
    glm::vec3 sum = glm::vec3(0.5f) + 0.28209479f * k[0];
    if (degree >= 1) sum += 0.48860251f * (-d.y * k[1] + d.z * k[2] - d.x * k[3]);
    if (degree >= 2)
        sum += 1.09254843f * (d.x * d.y * k[4] - d.y * d.z * k[5] - d.x * d.z * k[7]) +
               0.31539157f * (3 * d.z * d.z - 1) * k[6] + 0.54627422f * (d.x * d.x - d.y * d.y) * k[8];
    if (degree >= 3)
        sum += 0.59004359f * (-d.y * (3 * d.x * d.x - d.y * d.y) * k[9] - d.x * (d.x * d.x - 3 * d.y * d.y) * k[15]) +
               2.89061144f * d.x * d.y * d.z * k[10] +
               0.45704580f * (5 * d.z * d.z - 1) * (-d.y * k[11] - d.x * k[13]) +
               0.37317633f * d.z * (5 * d.z * d.z - 3) * k[12] + 1.44530572f * d.z * (d.x * d.x - d.y * d.y) * k[14];
    return glm::max(sum, glm::vec3(0));
}

// False where the splat is not in the image.
bool project(const Splat& splat, uint32_t degree, const stage::Camera& camera, const glm::dmat4& camera_from_world,
             Footprint& to) {
    const glm::vec3 at(camera_from_world * glm::dvec4(splat.centre, 1));
    const float depth = -at.z;
    if (depth < kNear_m || splat.opacity < kLeastAlpha) return false;
    const auto fx = static_cast<float>(camera.fx), fy = static_cast<float>(camera.fy);
    to.depth = depth;
    to.centre = {static_cast<float>(camera.cx) + fx * at.x / depth, static_cast<float>(camera.cy) - fy * at.y / depth};
    // The rows of the projection's derivative in the camera's axes, then in those of the splat, by deviations.
    const glm::mat3 splat_from_camera = glm::transpose(glm::mat3(camera_from_world) * glm::mat3_cast(splat.rotation));
    const glm::vec3 x = splat.deviation * (splat_from_camera * glm::vec3(fx / depth, 0, fx * at.x / (depth * depth)));
    const glm::vec3 y = splat.deviation * (splat_from_camera * glm::vec3(0, -fy / depth, -fy * at.y / (depth * depth)));
    const float xx = glm::dot(x, x) + kWidening_px2, yy = glm::dot(y, y) + kWidening_px2, xy = glm::dot(x, y);
    const float determinant = xx * yy - xy * xy;
    if (!(determinant > 0)) return false;
    to.a = yy / determinant;
    to.b = -xy / determinant;
    to.c = xx / determinant;
    const float reach = std::sqrt(2 * std::log(splat.opacity / kLeastAlpha));  // deviations
    to.reach_x = reach * std::sqrt(xx);
    to.reach = reach * std::sqrt(yy);
    if (to.centre.x + to.reach_x < 0 || to.centre.x - to.reach_x > static_cast<float>(camera.width) ||
        to.centre.y + to.reach < 0 || to.centre.y - to.reach > static_cast<float>(camera.height))
        return false;
    to.opacity = splat.opacity;
    to.colour = colour_at(splat.colour, degree, glm::normalize(splat.centre - glm::vec3(camera.world_from_camera[3])));
    return true;
}

// Calls add(footprint, x, y, alpha) for the pixels of the rows [first, end), near to far.
template <typename Add>
void composite_rows(const std::vector<Footprint>& footprints, uint32_t width, uint32_t first, uint32_t end,
                    const Add& add) {
    for (const Footprint& f : footprints) {
        const int y0 = std::max(static_cast<int>(first), static_cast<int>(std::floor(f.centre.y - f.reach)));
        const int y1 = std::min(static_cast<int>(end) - 1, static_cast<int>(std::ceil(f.centre.y + f.reach)));
        const int x0 = std::max(0, static_cast<int>(std::floor(f.centre.x - f.reach_x)));
        const int x1 = std::min(static_cast<int>(width) - 1, static_cast<int>(std::ceil(f.centre.x + f.reach_x)));
        for (int y = y0; y <= y1; ++y) {
            const float dy = static_cast<float>(y) + 0.5f - f.centre.y;
            for (int x = x0; x <= x1; ++x) {
                const float dx = static_cast<float>(x) + 0.5f - f.centre.x;
                const float power = -0.5f * (f.a * dx * dx + f.c * dy * dy) - f.b * dx * dy;
                const float alpha = std::min(kMostOpacity, f.opacity * std::exp(power));
                if (alpha >= kLeastAlpha) add(f, static_cast<uint32_t>(x), static_cast<uint32_t>(y), alpha);
            }
        }
    }
}

// The splats in the image, near to far.
std::vector<Footprint> footprints_of(const Splats& splats, const stage::Camera& camera) {
    const glm::dmat4 camera_from_world = glm::inverse(camera.world_from_camera);
    std::vector<Footprint> footprints;
    footprints.reserve(splats.splats.size());
    for (size_t i = 0; i < splats.splats.size(); ++i) {
        Footprint footprint{};
        footprint.splat = i;
        if (project(splats.splats[i], splats.degree, camera, camera_from_world, footprint))
            footprints.push_back(footprint);
    }
    std::sort(footprints.begin(), footprints.end(),
              [](const Footprint& a, const Footprint& b) { return a.depth < b.depth; });
    return footprints;
}

void for_rows(uint32_t height, const std::function<void(uint32_t first, uint32_t end)>& run) {
    parallel_for((height + kRowsOfPart - 1) / kRowsOfPart, 1, [&](size_t begin, size_t end) {
        run(static_cast<uint32_t>(begin) * kRowsOfPart, std::min(height, static_cast<uint32_t>(end) * kRowsOfPart));
    });
}

}  // namespace

media::Image splat_image(const Splats& splats, const stage::Camera& camera, const glm::vec3& background) {
    const std::vector<Footprint> footprints = footprints_of(splats, camera);
    const uint32_t width = camera.width;
    media::Image image(width, camera.height);
    for_rows(camera.height, [&](uint32_t first, uint32_t end) {
        std::vector<glm::vec4> rows(size_t{width} * (end - first), glm::vec4(0, 0, 0, 1));  // colour, transmittance
        composite_rows(footprints, width, first, end, [&](const Footprint& f, uint32_t x, uint32_t y, float alpha) {
            glm::vec4& pixel = rows[size_t{width} * (y - first) + x];
            pixel += glm::vec4(pixel.w * alpha * f.colour, -pixel.w * alpha);
        });
        for (size_t i = 0; i < rows.size(); ++i) {
            const glm::vec3 shown = glm::clamp(glm::vec3(rows[i]) + rows[i].w * background, 0.0f, 1.0f);
            uint8_t* to = image.at(0, first) + 4 * i;
            for (int c = 0; c < 3; ++c) to[c] = static_cast<uint8_t>(std::lround(255 * shown[c]));
            to[3] = 255;
        }
    });
    return image;
}

void add_weights(const Splats& splats, const stage::Camera& camera, std::vector<float>& weights) {
    const std::vector<Footprint> footprints = footprints_of(splats, camera);
    for_rows(camera.height, [&](uint32_t first, uint32_t end) {
        std::vector<float> transmittance(size_t{camera.width} * (end - first), 1.0f);
        composite_rows(footprints, camera.width, first, end,
                       [&](const Footprint& f, uint32_t x, uint32_t y, float alpha) {
                           float& left = transmittance[size_t{camera.width} * (y - first) + x];
                           std::atomic_ref(weights[f.splat]).fetch_add(left * alpha, std::memory_order_relaxed);
                           left *= 1 - alpha;
                       });
    });
}

}  // namespace neuvv::interchange
