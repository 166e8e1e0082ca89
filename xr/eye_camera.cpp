#include "xr/eye_camera.h"

#include <algorithm>
#include <cmath>

namespace neuvv {

Camera eye_camera(const EyeView& eye, const Pose& world_from_tracking, VkExtent2D size) {
    const double left = std::tan(eye.fov.angleLeft), right = std::tan(eye.fov.angleRight);
    const double up = std::tan(eye.fov.angleUp), down = std::tan(eye.fov.angleDown);
    constexpr double kMost = 100;  // of a tangent: 89.4°
    const bool sound = std::abs(left) < kMost && std::abs(right) < kMost && std::abs(up) < kMost &&
                       std::abs(down) < kMost && right - left > 1e-3 && up - down > 1e-3;
    if (!sound) throw RuntimeFailure("the headset's runtime gives an eye that sees nothing");
    Camera camera;
    camera.world_from_camera = matrix_of(world_from_tracking * eye.pose);
    camera.width = size.width;
    camera.height = size.height;
    camera.fx = size.width / (right - left);
    camera.fy = size.height / (up - down);
    camera.cx = -left * camera.fx;
    camera.cy = up * camera.fy;
    return camera;
}

std::vector<glm::vec2> hidden_corners(const Session& session, uint32_t eye, const XrFovf& fov) {
    const Runtime& runtime = session.runtime();
    if (!runtime.has(XR_KHR_VISIBILITY_MASK_EXTENSION_NAME)) return {};
    const auto get = runtime.function<PFN_xrGetVisibilityMaskKHR>("xrGetVisibilityMaskKHR");
    const auto ask = [&](XrVisibilityMaskKHR& mask) {
        return works(get(session.handle(), runtime.view_configuration(), eye,
                         XR_VISIBILITY_MASK_TYPE_HIDDEN_TRIANGLE_MESH_KHR, &mask),
                     "xrGetVisibilityMaskKHR", runtime.headset());
    };
    XrVisibilityMaskKHR mask{XR_TYPE_VISIBILITY_MASK_KHR};
    if (!ask(mask)) return {};
    std::vector<XrVector2f> vertices(mask.vertexCountOutput);
    std::vector<uint32_t> indices(mask.indexCountOutput);
    if (vertices.empty() || indices.empty()) return {};
    mask.vertexCapacityInput = mask.vertexCountOutput;
    mask.indexCapacityInput = mask.indexCountOutput;
    mask.vertices = vertices.data();
    mask.indices = indices.data();
    if (!ask(mask)) return {};
    indices.resize(std::min<size_t>(indices.size(), mask.indexCountOutput) / 3 * 3);
    const float left = std::tan(fov.angleLeft), right = std::tan(fov.angleRight);
    const float up = std::tan(fov.angleUp), down = std::tan(fov.angleDown);
    std::vector<glm::vec2> corners;
    for (const uint32_t i : indices) {
        if (i >= vertices.size()) return {};
        // On the plane one metre before the eye.
        corners.emplace_back((vertices[i].x - left) / (right - left), (up - vertices[i].y) / (up - down));
    }
    return corners;
}

Fovea fovea_of(const Camera& eye, double share, double beside) {
    const glm::dvec2 middle =
        glm::clamp(glm::dvec2(eye.cx / eye.width, eye.cy / eye.height), 0.5 * share, 1 - 0.5 * share);
    return {middle - 0.5 * share, middle + 0.5 * share, beside};
}

}  // namespace neuvv
