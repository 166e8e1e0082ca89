#include "xr/draw/eye_camera.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace neuvv::xr {

stage::Camera eye_camera(const EyeView& eye, const Pose& world_from_tracking, VkExtent2D size) {
    assert(spans_image(eye.fov));
    const double left = std::tan(double{eye.fov.angleLeft}), right = std::tan(double{eye.fov.angleRight});
    const double up = std::tan(double{eye.fov.angleUp}), down = std::tan(double{eye.fov.angleDown});
    stage::Camera camera;
    camera.world_from_camera = matrix_of(world_from_tracking * eye.pose);
    camera.width = size.width;
    camera.height = size.height;
    camera.fx = size.width / (right - left);
    camera.fy = size.height / (up - down);
    camera.cx = -left * camera.fx;
    camera.cy = up * camera.fy;
    return camera;
}

std::vector<glm::vec2> hidden_triangles(const Session& session, uint32_t view, const XrFovf& fov) {
    const Runtime& runtime = session.runtime();
    if (!runtime.has(XR_KHR_VISIBILITY_MASK_EXTENSION_NAME)) return {};
    const auto get = runtime.function<PFN_xrGetVisibilityMaskKHR>("xrGetVisibilityMaskKHR");
    const auto get_mask = [&](XrVisibilityMaskKHR& mask) {
        return succeeded(get(session.handle(), runtime.view_configuration(), view,
                             XR_VISIBILITY_MASK_TYPE_HIDDEN_TRIANGLE_MESH_KHR, &mask),
                         "xrGetVisibilityMaskKHR", runtime.headset());
    };
    XrVisibilityMaskKHR mask{XR_TYPE_VISIBILITY_MASK_KHR};
    if (!get_mask(mask)) return {};
    std::vector<XrVector2f> vertices(mask.vertexCountOutput);
    std::vector<uint32_t> indices(mask.indexCountOutput);
    if (vertices.empty() || indices.empty()) return {};
    mask.vertexCapacityInput = mask.vertexCountOutput;
    mask.indexCapacityInput = mask.indexCountOutput;
    mask.vertices = vertices.data();
    mask.indices = indices.data();
    if (!get_mask(mask)) return {};
    indices.resize(std::min<size_t>(indices.size(), mask.indexCountOutput));
    return corners_in_image(vertices, indices, fov);
}

std::vector<glm::vec2> corners_in_image(std::span<const XrVector2f> vertices, std::span<const uint32_t> indices,
                                        const XrFovf& fov) {
    const float left = std::tan(fov.angleLeft), right = std::tan(fov.angleRight);
    const float up = std::tan(fov.angleUp), down = std::tan(fov.angleDown);
    std::vector<glm::vec2> corners;
    for (const uint32_t i : indices.first(indices.size() / 3 * 3)) {
        if (i >= vertices.size()) return {};
        corners.emplace_back((vertices[i].x - left) / (right - left), (up - vertices[i].y) / (up - down));
    }
    return corners;
}

render::Fovea fovea_of(const stage::Camera& eye, double share, double beside,
                       const std::optional<glm::dvec3>& looks_at_world) {
    glm::dvec2 pixel(eye.cx, eye.cy);
    if (looks_at_world) {
        const glm::dvec3 at(glm::inverse(eye.world_from_camera) * glm::dvec4(*looks_at_world, 1));
        if (at.z < 0) pixel += glm::dvec2(eye.fx * at.x, -eye.fy * at.y) / -at.z;
    }
    const glm::dvec2 centre = glm::clamp(pixel / glm::dvec2(eye.width, eye.height), 0.5 * share, 1 - 0.5 * share);
    return {centre - 0.5 * share, centre + 0.5 * share, beside};
}

}  // namespace neuvv::xr
