#include "render/set/set_lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "render/set/raster.h"

namespace neuvv::render {

namespace {

constexpr double kMaxHalfAngle = 80 * std::numbers::pi / 180;

// The world_from_camera matrix of a camera that looks along `direction`.
glm::dmat4 looking_along(const glm::dvec3& direction, const glm::dvec3& position) {
    const glm::dvec3 back = -glm::normalize(direction);
    const glm::dvec3 helper_axis = std::abs(back.y) < 0.99 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, -1);
    const glm::dvec3 right = glm::normalize(glm::cross(helper_axis, back));
    return {glm::dvec4(right, 0), glm::dvec4(glm::cross(back, right), 0), glm::dvec4(back, 0), glm::dvec4(position, 1)};
}

glm::dmat4 directional_matrix(const glm::dvec3& direction, const WorldBox& box) {
    const glm::dmat4 from_world = glm::inverse(looking_along(direction, glm::dvec3(0)));
    glm::dvec3 low(INFINITY), high(-INFINITY);
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 point(corner & 1 ? box.second.x : box.first.x, corner & 2 ? box.second.y : box.first.y,
                               corner & 4 ? box.second.z : box.first.z);
        const glm::dvec3 in_light(from_world * glm::dvec4(point, 1));
        low = glm::min(low, in_light);
        high = glm::max(high, in_light);
    }
    // Texels are square. There is a margin for the shadow filter and for surfaces parallel to the light.
    const double half = 0.51 * std::max({high.x - low.x, high.y - low.y, 1e-3});
    const double depth = 1.02 * std::max(high.z - low.z, 1e-3);
    const glm::dvec3 centre = 0.5 * (low + high);
    glm::dmat4 clip(1);
    clip[0][0] = 1 / half;
    clip[1][1] = -1 / half;
    clip[2][2] = 1 / depth;  // 1 next to the light, 0 behind the box
    clip[3] = {-centre.x / half, centre.y / half, 0.5 - centre.z / depth, 1};
    return clip * from_world;
}

ShaderLight pack_light(const SetLight& light) {
    ShaderLight out{};
    out.position = glm::vec4(light.position, light.range_m);
    out.direction = glm::vec4(glm::normalize(light.direction), 0);
    out.colour = glm::vec4(light.colour, 0);
    out.kind = static_cast<uint32_t>(light.kind);
    out.shadow = kNoShadow;
    const double scale = 1 / std::max(1e-3, light.inner_cos - light.outer_cos);
    out.cone_scale = static_cast<float>(scale);
    out.cone_offset = static_cast<float>(-light.outer_cos * scale);
    return out;
}

}  // namespace

Irradiance turned(const Irradiance& irradiance, double rotation) {
    const double c = std::cos(rotation), s = std::sin(rotation);
    const glm::dmat3 turn(c, 0, -s, 0, 1, 0, s, 0, c);
    Irradiance out = irradiance;
    for (int k = 0; k < 3; ++k) {
        const auto of = [&](size_t i) { return irradiance[i][k]; };
        // The polynomial as constant + linear · n + nᵀ Q n, where Q is symmetric and has trace 0.
        const glm::dvec3 linear = turn * glm::dvec3(of(3), of(1), of(2));
        const glm::dmat3 q(of(8) - of(6), of(4) / 2, of(7) / 2, of(4) / 2, -of(6) - of(8), of(5) / 2, of(7) / 2,
                           of(5) / 2, 2 * of(6));
        const glm::dmat3 r = turn * q * glm::transpose(turn);
        const double values[] = {linear.y,    linear.z,    linear.x,    2 * r[0][1],
                                 2 * r[1][2], r[2][2] / 2, 2 * r[0][2], (r[0][0] - r[1][1]) / 2};
        for (size_t i = 1; i < 9; ++i) out[i][k] = values[i - 1];
    }
    return out;
}

stage::Camera shadow_camera(const SetLight& light, uint32_t side) {
    stage::Camera camera;
    camera.world_from_camera = looking_along(light.direction, light.position);
    const double half_angle = std::clamp(std::acos(std::clamp(light.outer_cos, -1.0, 1.0)), 1e-3, kMaxHalfAngle);
    camera.width = camera.height = side;
    camera.cx = camera.cy = side / 2.0;
    camera.fx = camera.fy = camera.cx / std::tan(half_angle);
    return camera;
}

stage::Camera performer_shadow_camera(const SetLight& light, const WorldBox& performers, uint32_t side) {
    if (light.kind == SetLightKind::kSpot) return shadow_camera(light, side);
    constexpr double kFar = 100;  // radii of the bounding sphere of the box
    const double radius = std::max(0.5 * glm::distance(performers.first, performers.second), 1e-3);
    const glm::dvec3 centre = 0.5 * (performers.first + performers.second);
    stage::Camera camera;
    camera.world_from_camera = looking_along(light.direction, centre - kFar * radius * glm::normalize(light.direction));
    camera.width = camera.height = side;
    camera.cx = camera.cy = side / 2.0;
    camera.fx = camera.fy = camera.cx * std::sqrt(kFar * kFar - 1);  // the sphere touches the image's sides
    return camera;
}

glm::dmat4 shadow_matrix(const SetLight& light, const WorldBox& box) {
    if (light.kind == SetLightKind::kDirectional) return directional_matrix(light.direction, box);
    return clip_from_world(shadow_camera(light, kSetShadowSide), static_cast<double>(kShadowNear));
}

ShaderLights pack_lights(std::span<const SetLight> lights, const SetAmbient& ambient, const SetShadows& shadows,
                         const Irradiance& environment, const WorldBox& set,
                         const std::optional<WorldBox>& performers) {
    ShaderLights out{};
    uint32_t maps = 0;
    for (const SetLight& light : lights) {
        if (out.count == kMaxSetLights) break;
        ShaderLight& to = out.light[out.count++] = pack_light(light);
        if (!light.casts_shadow || light.kind == SetLightKind::kPoint || maps == kMaxShadows) continue;
        to.shadow = maps++;
        to.clip_from_world = glm::mat4(shadow_matrix(light, set));
        if (!performers) continue;
        const stage::Camera camera = performer_shadow_camera(light, *performers, kPerformerShadowSide);
        to.performer_clip_from_world = glm::mat4(clip_from_world(camera, static_cast<double>(kShadowNear)));
        to.performer_eye = camera.world_from_camera[3];
    }
    const Irradiance rotated = turned(environment, ambient.environment_rotation);
    for (size_t i = 0; i < rotated.size(); ++i)
        out.irradiance[i] = glm::vec4(ambient.environment_intensity * rotated[i], 0);
    out.irradiance[0] += glm::vec4(ambient.light, 0);
    out.ambient = glm::vec4(ambient.light, 0);
    out.environment = {ambient.environment_intensity, 0, std::cos(ambient.environment_rotation),
                       std::sin(ambient.environment_rotation)};
    out.set_shadows = shadows.set;
    out.performer_shadows = shadows.performers;
    return out;
}

}  // namespace neuvv::render
