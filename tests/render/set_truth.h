// The expected image of a set: surfaces that rays meet, lit in double precision.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <optional>

#include "reference/camera.h"
#include "reference/lights.h"
#include "reference/pbr.h"
#include "support/look_at.h"
#include "support/set_scene.h"

namespace neuvv::test {

using reference::PbrMaterial;

constexpr uint32_t kSide = 48;

// The point where a pixel's ray meets a surface, and the surface's normal.
struct Hit {
    glm::dvec3 position, normal;
};
using Surface = std::function<std::optional<Hit>(const reference::Ray&)>;

// The floor y = 0 for |x|, |z| < half, which is shaded with `normal`.
inline Surface floor_of(double half, glm::dvec3 normal = {0, 1, 0}) {
    return [half, normal](const reference::Ray& ray) -> std::optional<Hit> {
        const double t = -ray.origin.y / ray.direction.y;
        const glm::dvec3 position = ray.origin + t * ray.direction;
        if (t <= 0 || std::max(std::abs(position.x), std::abs(position.z)) >= half) return std::nullopt;
        return Hit{position, normal};
    };
}

inline Surface ball_of(glm::dvec3 centre, double radius) {
    return [=](const reference::Ray& ray) -> std::optional<Hit> {
        const glm::dvec3 to = centre - ray.origin;
        const double along = glm::dot(to, ray.direction), inside = along * along - glm::dot(to, to) + radius * radius;
        if (inside < 0) return std::nullopt;
        const glm::dvec3 position = ray.origin + (along - std::sqrt(inside)) * ray.direction;
        return Hit{position, (position - centre) / radius};
    };
}

inline MeshData floor_mesh(float half = 1.5f) {
    return rectangle({-half, 0, half}, {2 * half, 0, 0}, {0, 0, -2 * half});
}

inline stage::Camera camera_above() {
    return look_at({0.4, 1.3, 2.2}, {0, 0, 0}, kSide, kSide, 1.1);
}

struct Lighting {
    std::vector<render::SetLight> lights;
    render::SetAmbient ambient;
    glm::dvec3 emitted{0};
    double occlusion = 1;  // the fraction of the ambient light that arrives
    // The fraction of a light that arrives at a position; negative: the position is not compared.
    std::function<double(const render::SetLight&, glm::dvec3)> visible = [](const render::SetLight&, glm::dvec3) {
        return 1.0;
    };
};

inline glm::dvec3 expected_light(const Hit& hit, const glm::dvec3& to_eye, const PbrMaterial& material,
                                 const Lighting& lighting) {
    const glm::dvec3 ambient = lighting.ambient.light;
    glm::dvec3 sum = lighting.emitted +
                     lighting.occlusion * reference::reflect_ambient(material, hit.normal, to_eye, ambient, ambient);
    for (const render::SetLight& light : lighting.lights) {
        glm::dvec3 to_light;
        const glm::dvec3 arriving = reference::light_at(light, hit.position, to_light);
        sum += lighting.visible(light, hit.position) * arriving *
               reference::brdf(material, hit.normal, to_eye, to_light) * std::max(glm::dot(hit.normal, to_light), 0.0);
    }
    return sum;
}

inline bool is_compared(const Hit& hit, const Lighting& lighting) {
    for (const render::SetLight& light : lighting.lights)
        if (lighting.visible(light, hit.position) < 0) return false;
    return true;
}

struct Agreement {
    double worst = 0;  // error of the colour, relative to the colour plus 0.01
    double depth = 0;  // relative error
    size_t covered = 0;
    size_t wrong_cover = 0;  // texels that are covered in only one of the two
};

// Whether the texel is at an edge of the surface: some rays near it hit the surface and others do not. Edges are not
// compared.
inline bool at_edge(const Surface& surface, const stage::Camera& camera, uint32_t x, uint32_t y) {
    const bool hit = surface(reference::camera_ray(camera, x, y)).has_value();
    for (const double dx : {-0.6, 0.6})
        for (const double dy : {-0.6, 0.6})
            if (surface(reference::camera_ray(camera, x + dx, y + dy)).has_value() != hit) return true;
    return false;
}

// What a texel may show: where vertices are moved to a grid, a point of the surface that lies up to half a step of it
// away along each axis of the image.
struct TexelTruth {
    glm::dvec3 least{INFINITY}, most{-INFINITY};  // colour
    double nearest_m = INFINITY, farthest_m = -INFINITY;
};

inline TexelTruth texel_truth(const stage::Camera& camera, const Surface& surface, const PbrMaterial& material,
                              const Lighting& lighting, uint32_t x, uint32_t y, double grid_px) {
    const glm::dvec3 eye(camera.world_from_camera[3]), forward(-camera.world_from_camera[2]);
    TexelTruth truth;
    const std::vector<double> offsets = grid_px > 0 ? std::vector{-0.5 * grid_px, 0.5 * grid_px} : std::vector{0.0};
    for (const double dx : offsets)
        for (const double dy : offsets) {
            const auto hit = surface(reference::camera_ray(camera, x + dx, y + dy));
            const glm::dvec3 light = expected_light(*hit, glm::normalize(eye - hit->position), material, lighting);
            truth.least = glm::min(truth.least, light);
            truth.most = glm::max(truth.most, light);
            const double along = glm::dot(hit->position - eye, forward);
            truth.nearest_m = std::min(truth.nearest_m, along);
            truth.farthest_m = std::max(truth.farthest_m, along);
        }
    return truth;
}

// How far a value lies outside of the range.
inline double outside(double value, double least, double most) {
    return std::isnan(value) || !(least <= most) ? INFINITY : std::max({least - value, value - most, 0.0});
}

inline Agreement compare(const SetImages& images, const stage::Camera& camera, const Surface& surface,
                         const PbrMaterial& material, const Lighting& lighting, size_t first_texel = 0) {
    Agreement agreement;
    for (uint32_t y = 0; y < camera.height; ++y)
        for (uint32_t x = 0; x < camera.width; ++x) {
            if (at_edge(surface, camera, x, y)) continue;
            const size_t texel = first_texel + size_t{y} * camera.width + x;
            const auto hit = surface(reference::camera_ray(camera, x, y));
            const glm::dvec4 drawn = images.colour[texel];
            const float metres = images.depth_m[texel];
            agreement.wrong_cover +=
                hit ? drawn.a != 1 || std::isinf(metres) : drawn != glm::dvec4(0) || metres != INFINITY;
            if (!hit || !is_compared(*hit, lighting)) continue;
            ++agreement.covered;
            const TexelTruth truth = texel_truth(camera, surface, material, lighting, x, y, images.grid_px);
            for (int c = 0; c < 3; ++c)
                agreement.worst = std::max(agreement.worst,
                                           outside(drawn[c], truth.least[c], truth.most[c]) / (truth.most[c] + 0.01));
            agreement.depth =
                std::max(agreement.depth, outside(metres, truth.nearest_m, truth.farthest_m) / truth.farthest_m);
        }
    return agreement;
}

// Rounding to fp16 is an error of up to 1/2048 of a value; the rest is single precision in sharp highlights.
constexpr double kColourTolerance = 2e-3;
constexpr double kDepthTolerance = 2e-6;

inline SetImages draw(const gpu::Device& device, const GlbBuilder& glb, const stage::Camera& camera,
                      const Lighting& lighting) {
    const stage::GltfScene scene = scene_of(glb);
    render::SetRaster set(device, scene, camera.width, camera.height, 1);
    set.pose(stage::pose_scene(scene, stage::kNoAnimation, 0));
    set.lighting.light(lighting.lights, lighting.ambient);
    return draw_set(device, set, {camera});
}

inline render::SetLight directional() {
    render::SetLight light;
    light.kind = render::SetLightKind::kDirectional;
    light.direction = glm::normalize(glm::dvec3(0.4, -1, -0.3));
    light.colour = {2, 1.5, 1};
    return light;
}

inline render::SetLight point() {
    render::SetLight light;
    light.kind = render::SetLightKind::kPoint;
    light.position = {-0.7, 0.9, 0.5};
    light.colour = {1, 2, 3};
    return light;
}

inline render::SetLight spot() {
    render::SetLight light;
    light.kind = render::SetLightKind::kSpot;
    light.position = {0.8, 1.6, 0.6};
    light.direction = glm::normalize(glm::dvec3(-0.6, -1.5, -0.5));
    light.colour = {5, 4, 3};
    light.inner_cos = std::cos(0.2);
    light.outer_cos = std::cos(0.5);
    return light;
}

}  // namespace neuvv::test
