#include "stage/gltf/gltf_tangents.h"

#include <algorithm>
#include <cmath>

namespace neuvv::stage {

namespace {

struct UvGradient {
    glm::dvec3 along_u{0}, along_v{0};  // unit, or 0 where the triangle or its UVs have no area
};

UvGradient uv_gradient(const GltfPrimitive& primitive, const std::vector<glm::vec2>& uvs, const uint32_t* corners) {
    const glm::dvec3 origin = primitive.positions[corners[0]];
    const glm::dvec3 e1 = glm::dvec3(primitive.positions[corners[1]]) - origin,
                     e2 = glm::dvec3(primitive.positions[corners[2]]) - origin;
    const glm::dvec2 d1 = glm::dvec2(uvs[corners[1]]) - glm::dvec2(uvs[corners[0]]),
                     d2 = glm::dvec2(uvs[corners[2]]) - glm::dvec2(uvs[corners[0]]);
    // (e1 e2) = (∂p/∂u ∂p/∂v)·(d1 d2), solved up to the determinant's absolute value.
    const double side = d1.x * d2.y - d2.x * d1.y;
    const auto unit = [](const glm::dvec3& v) {
        const double length = glm::length(v);
        return length > 0 && std::isfinite(length) ? v / length : glm::dvec3(0);
    };
    if (side == 0 || !std::isfinite(side)) return {};
    const double sign = side > 0 ? 1 : -1;
    return {unit(sign * (d2.y * e1 - d1.y * e2)), unit(sign * (d1.x * e2 - d2.x * e1))};
}

double angle_at(const GltfPrimitive& primitive, const uint32_t* corners, int k) {
    const glm::dvec3 at = primitive.positions[corners[k]];
    const glm::dvec3 a = glm::dvec3(primitive.positions[corners[(k + 1) % 3]]) - at,
                     b = glm::dvec3(primitive.positions[corners[(k + 2) % 3]]) - at;
    const double lengths = glm::length(a) * glm::length(b);
    const double angle = lengths > 0 ? std::acos(std::clamp(glm::dot(a, b) / lengths, -1.0, 1.0)) : 0;
    return std::isfinite(angle) ? angle : 0;
}

}  // namespace

glm::vec4 tangent_across(const glm::vec3& normal, const glm::vec3& along, bool mirrored) {
    const glm::dvec3 n = normal, t = glm::dvec3(along) - glm::dot(glm::dvec3(along), n) * n;
    const double length = glm::length(t);
    const float side = mirrored ? -1.0f : 1.0f;
    if (length > 1e-9 && std::isfinite(length)) return {glm::vec3(t / length), side};
    const glm::dvec3 axis = std::abs(n.x) < 0.6 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
    return {glm::vec3(glm::normalize(axis - glm::dot(axis, n) * n)), side};
}

void add_tangents(GltfPrimitive& primitive) {
    const std::vector<glm::vec2>& uvs = primitive.map_uvs[static_cast<size_t>(GltfMap::kNormal)];
    if (uvs.empty()) return;
    std::vector<UvGradient> sums(primitive.positions.size());
    for (size_t i = 0; i + 2 < primitive.indices.size(); i += 3) {
        const uint32_t* corners = &primitive.indices[i];
        const UvGradient gradient = uv_gradient(primitive, uvs, corners);
        for (int k = 0; k < 3; ++k) {
            const double angle = angle_at(primitive, corners, k);
            sums[corners[k]].along_u += angle * gradient.along_u;
            sums[corners[k]].along_v += angle * gradient.along_v;
        }
    }
    primitive.tangents.reserve(sums.size());
    for (size_t v = 0; v < sums.size(); ++v) {
        const glm::dvec3 up = -sums[v].along_v, across = glm::cross(glm::dvec3(primitive.normals[v]), sums[v].along_u);
        primitive.tangents.push_back(
            tangent_across(primitive.normals[v], glm::vec3(sums[v].along_u), glm::dot(across, up) < 0));
    }
}

}  // namespace neuvv::stage
