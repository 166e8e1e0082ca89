#include "editor/pointer.h"

#include <algorithm>
#include <cmath>

namespace neuvv::editor {

namespace {

constexpr double kMaxPosition_px = 1e6;

glm::dvec3 eye_of(const stage::Camera& camera) {
    return camera.world_from_camera[3];
}

// A direction in the axes of the camera: x and y in the image plane, z towards the viewer.
glm::dvec3 in_camera(const stage::Camera& camera, glm::dvec3 direction) {
    return glm::transpose(glm::dmat3(camera.world_from_camera)) * direction;
}

glm::dvec2 project_in_camera(const stage::Camera& camera, glm::dvec3 p) {
    return {camera.cx - camera.fx * p.x / p.z, camera.cy + camera.fy * p.y / p.z};
}

}  // namespace

bool is_valid_pointer(glm::dvec2 pointer) {
    return std::abs(pointer.x) <= kMaxPosition_px && std::abs(pointer.y) <= kMaxPosition_px;
}

Ray ray_through(const stage::Camera& camera, glm::dvec2 pixel) {
    const glm::dvec3 line((pixel.x - camera.cx) / camera.fx, -(pixel.y - camera.cy) / camera.fy, -1);
    return {eye_of(camera), glm::normalize(glm::dmat3(camera.world_from_camera) * line)};
}

double depth_of(const stage::Camera& camera, glm::dvec3 world) {
    return -in_camera(camera, world - eye_of(camera)).z;
}

std::optional<glm::dvec2> pixel_of(const stage::Camera& camera, glm::dvec3 world) {
    const glm::dvec3 p = in_camera(camera, world - eye_of(camera));
    if (!(p.z <= -kMinDepth_m)) return std::nullopt;
    return project_in_camera(camera, p);
}

std::optional<std::pair<glm::dvec2, glm::dvec2>> pixels_of(const stage::Camera& camera, glm::dvec3 a, glm::dvec3 b) {
    glm::dvec3 p = in_camera(camera, a - eye_of(camera)), q = in_camera(camera, b - eye_of(camera));
    if (!(std::min(p.z, q.z) <= -kMinDepth_m)) return std::nullopt;
    glm::dvec3& behind = p.z > q.z ? p : q;
    const glm::dvec3& before = p.z > q.z ? q : p;
    if (behind.z > -kMinDepth_m)
        behind = before + (behind - before) * ((-kMinDepth_m - before.z) / (behind.z - before.z));
    return std::pair{project_in_camera(camera, p), project_in_camera(camera, q)};
}

double metres_of_pixels(const stage::Camera& camera, glm::dvec3 world, double pixels) {
    return pixels * depth_of(camera, world) / camera.fy;
}

std::optional<double> line_drag(const stage::Camera& camera, glm::dvec3 through, glm::dvec3 along, double handle,
                                glm::dvec2 pointer) {
    const glm::dvec3 p = in_camera(camera, through - eye_of(camera)), a = in_camera(camera, along);
    const double depth = -p.z, recedes = -a.z;  // the depth of the point at s is depth + s · recedes
    if (!(depth >= kMinDepth_m)) return std::nullopt;
    // A point of the line appears at pixel(0) + k · across, where k = s / (depth · (depth + s · recedes)).
    const glm::dvec2 across(camera.fx * (a.x * depth - p.x * recedes), -camera.fy * (a.y * depth - p.y * recedes));
    const double length2 = glm::dot(across, across);
    if (!(std::sqrt(length2) * std::abs(handle) >= kEndOn_px * depth * depth)) return std::nullopt;
    const double k = glm::dot(pointer - project_in_camera(camera, p), across) / length2;
    // This is depth / (depth + s · recedes): 0 where the line vanishes, and unbounded towards the plane of the camera.
    const double nearness = 1 - k * depth * recedes;
    if (nearness < 1 / kMaxDepthFactor) return depth * (kMaxDepthFactor - 1) / recedes;
    return k * depth * depth / nearness;
}

std::optional<glm::dvec3> plane_drag(const stage::Camera& camera, glm::dvec3 through, glm::dvec3 normal,
                                     glm::dvec2 pointer) {
    const glm::dvec3 to_plane = through - eye_of(camera);
    const double distance = glm::length(to_plane);
    double height = glm::dot(normal, to_plane);
    if (!(distance >= kMinDepth_m && std::abs(height) >= kEdgeOn * distance * glm::length(normal))) return std::nullopt;
    const glm::dvec3 up = glm::normalize(height < 0 ? -normal : normal);
    height = glm::dot(up, to_plane);
    const Ray ray = ray_through(camera, pointer);
    // Near the horizon the ray ends at kMaxDepthFactor times the distance, off the plane; the result is the point of
    // the plane that is nearest to its end.
    const double along = height / std::max(glm::dot(up, ray.direction), height / (kMaxDepthFactor * distance));
    const glm::dvec3 met = ray.direction * along;
    return ray.origin + met - up * (glm::dot(up, met) - height);
}

glm::dvec3 perpendicular_to(glm::dvec3 v) {
    const glm::dvec3 a = glm::abs(v);
    const glm::dvec3 smallest_axis(a.x <= a.y && a.x <= a.z, a.y < a.x && a.y <= a.z, a.z < a.x && a.z < a.y);
    return glm::normalize(glm::cross(v, smallest_axis));
}

glm::dvec3 facing_normal(const stage::Camera& camera) {
    return glm::dvec3(camera.world_from_camera[2]);
}

double snapped(double value, double step, bool snap) {
    return snap ? std::round(value / step) * step : value;
}

}  // namespace neuvv::editor
