#include "interchange/mesh/mesh_image.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace neuvv::interchange {

namespace {

constexpr double kNearest_m = 0.01;

// A triangle in an image. Weights of its corners are linear in the image once they are divided by depth.
struct Drawn {
    std::array<glm::dvec2, 3> at;  // pixels
    std::array<double, 3> inverse_depth;
};

struct Sample {
    double inverse_depth = 0;  // along the camera's axis; 0: nothing
    uint32_t triangle = 0;
    glm::dvec3 weights{0};
};

bool project(const ColouredMesh& mesh, const glm::uvec3& triangle, const stage::Camera& camera,
             const glm::dmat4& camera_from_world, Drawn& to) {
    for (size_t k = 0; k < 3; ++k) {
        const glm::dvec4 at = camera_from_world * glm::dvec4(mesh.mesh.positions[triangle[static_cast<int>(k)]], 1);
        if (-at.z < kNearest_m) return false;
        to.inverse_depth[k] = -1 / at.z;
        to.at[k] = {camera.cx + camera.fx * at.x * to.inverse_depth[k],
                    camera.cy - camera.fy * at.y * to.inverse_depth[k]};
    }
    return true;
}

double cross(const glm::dvec2& a, const glm::dvec2& b) {
    return a.x * b.y - a.y * b.x;
}

void draw(const Drawn& drawn, uint32_t triangle, const stage::Camera& camera, std::vector<Sample>& samples) {
    const auto& [a, b, c] = drawn.at;
    const double area = cross(b - a, c - a);
    if (area == 0) return;
    const glm::dvec2 low = glm::ceil(glm::min(glm::min(a, b), c) - 0.5);
    const glm::dvec2 high = glm::floor(glm::max(glm::max(a, b), c) - 0.5);
    const double width = camera.width, height = camera.height;
    const int x0 = static_cast<int>(std::clamp(low.x, 0.0, width)),
              y0 = static_cast<int>(std::clamp(low.y, 0.0, height));
    const int x1 = static_cast<int>(std::clamp(high.x, -1.0, width - 1));
    const int y1 = static_cast<int>(std::clamp(high.y, -1.0, height - 1));
    for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) {
            const glm::dvec2 p = glm::dvec2(x, y) + 0.5;
            glm::dvec3 weights = glm::dvec3(cross(b - p, c - p), cross(c - p, a - p), cross(a - p, b - p)) / area;
            if (weights.x < 0 || weights.y < 0 || weights.z < 0) continue;
            for (int k = 0; k < 3; ++k) weights[k] *= drawn.inverse_depth[static_cast<size_t>(k)];
            const double inverse_depth = weights.x + weights.y + weights.z;
            Sample& sample = samples[static_cast<size_t>(y) * camera.width + static_cast<size_t>(x)];
            if (inverse_depth > sample.inverse_depth) sample = {inverse_depth, triangle, weights / inverse_depth};
        }
}

glm::dvec3 texel(const media::Image& texture, const glm::dvec2& uv) {
    const glm::dvec2 at = uv * glm::dvec2(texture.width, texture.height) - 0.5, first = glm::floor(at);
    glm::dvec3 sum(0);
    for (const int y : {0, 1})
        for (const int x : {0, 1}) {
            const double weight =
                (x == 1 ? at.x - first.x : 1 - at.x + first.x) * (y == 1 ? at.y - first.y : 1 - at.y + first.y);
            const auto column = static_cast<uint32_t>(std::clamp(first.x + x, 0.0, texture.width - 1.0));
            const auto row = static_cast<uint32_t>(std::clamp(first.y + y, 0.0, texture.height - 1.0));
            const uint8_t* rgba = texture.at(column, row);
            sum += weight * glm::dvec3(rgba[0], rgba[1], rgba[2]);
        }
    return sum / 255.0;
}

// sRGB-encoded.
glm::dvec3 colour_of(const ColouredMesh& mesh, const Sample& sample) {
    const glm::uvec3& triangle = mesh.mesh.triangles[sample.triangle];
    glm::dvec2 uv(0);
    glm::dvec3 colour(0);
    for (int k = 0; k < 3; ++k) {
        if (mesh.colours.empty()) {
            uv += sample.weights[k] * glm::dvec2(mesh.mesh.uvs[triangle[k]]);
        } else {
            const std::array<uint8_t, 3>& of_corner = mesh.colours[triangle[k]];
            colour += sample.weights[k] / 255 * glm::dvec3(of_corner[0], of_corner[1], of_corner[2]);
        }
    }
    return mesh.colours.empty() ? texel(mesh.texture, uv) : colour;
}

}  // namespace

media::LinearImage mesh_image(const ColouredMesh& mesh, const stage::Camera& camera, uint32_t samples) {
    const stage::Camera fine = stage::enlarged(camera, samples);
    const glm::dmat4 camera_from_world = glm::inverse(fine.world_from_camera);
    std::vector<Sample> all(size_t{fine.width} * fine.height);
    for (uint32_t i = 0; i < mesh.mesh.triangles.size(); ++i)
        if (Drawn drawn; project(mesh, mesh.mesh.triangles[i], fine, camera_from_world, drawn))
            draw(drawn, i, fine, all);
    media::LinearImage image{camera.width, camera.height};
    image.rgba.resize(size_t{4} * camera.width * camera.height);
    image.depth_m.resize(size_t{camera.width} * camera.height);
    const size_t of_pixel = size_t{samples} * samples;
    for (size_t pixel = 0; pixel < image.depth_m.size(); ++pixel) {
        glm::dvec3 light(0);
        double depth = 0, count = 0;
        for (size_t i = 0; i < of_pixel; ++i) {
            const size_t x = samples * (pixel % camera.width) + i % samples;
            const size_t y = samples * (pixel / camera.width) + i / samples;
            const Sample& sample = all[y * fine.width + x];
            if (sample.inverse_depth == 0) continue;
            const glm::dvec3 srgb = colour_of(mesh, sample);
            for (int c = 0; c < 3; ++c) light[c] += media::linear_from_srgb(srgb[c]);
            depth += 1 / sample.inverse_depth;
            ++count;
        }
        for (size_t c = 0; c < 3; ++c)
            image.rgba[4 * pixel + c] = static_cast<float>(light[static_cast<int>(c)] / static_cast<double>(of_pixel));
        image.rgba[4 * pixel + 3] = static_cast<float>(count / static_cast<double>(of_pixel));
        image.depth_m[pixel] = count > 0 ? static_cast<float>(depth / count) : std::numeric_limits<float>::infinity();
    }
    return image;
}

}  // namespace neuvv::interchange
