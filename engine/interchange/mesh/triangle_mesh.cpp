#include "interchange/mesh/triangle_mesh.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace neuvv::interchange {

namespace {

// The first vertex of the part that a vertex belongs to.
uint32_t part_of(std::vector<uint32_t>& parents, uint32_t vertex) {
    while (parents[vertex] != vertex) vertex = parents[vertex] = parents[parents[vertex]];
    return vertex;
}

std::vector<uint32_t> parts_of(const TriangleMesh& mesh) {
    std::vector<uint32_t> parents(mesh.positions.size());
    std::iota(parents.begin(), parents.end(), 0u);
    for (const glm::uvec3& triangle : mesh.triangles)
        for (int i = 1; i < 3; ++i) {
            const uint32_t a = part_of(parents, triangle[0]), b = part_of(parents, triangle[i]);
            parents[std::max(a, b)] = std::min(a, b);
        }
    for (uint32_t i = 0; i < parents.size(); ++i) parents[i] = part_of(parents, i);
    return parents;
}

}  // namespace

glm::vec3 cross_of(const TriangleMesh& mesh, const glm::uvec3& triangle) {
    const glm::vec3& a = mesh.positions[triangle[0]];
    return glm::cross(mesh.positions[triangle[1]] - a, mesh.positions[triangle[2]] - a);
}

std::vector<glm::vec3> normals_of(const TriangleMesh& mesh) {
    std::vector<glm::vec3> normals(mesh.positions.size(), glm::vec3(0));
    for (const glm::uvec3& triangle : mesh.triangles) {
        const glm::vec3 cross = cross_of(mesh, triangle);
        for (int i = 0; i < 3; ++i) normals[triangle[i]] += cross;
    }
    for (glm::vec3& normal : normals) {
        const float length = glm::length(normal);
        normal = length > 0 ? normal / length : glm::vec3(0, 1, 0);
    }
    return normals;
}

TriangleMesh without_small_parts(const TriangleMesh& mesh, double smallest_share) {
    const std::vector<uint32_t> parts = parts_of(mesh);
    constexpr glm::vec3 kFar(std::numeric_limits<float>::max());
    std::vector<glm::vec3> low(parts.size(), kFar), high(parts.size(), -kFar);
    for (size_t i = 0; i < parts.size(); ++i) {
        low[parts[i]] = glm::min(low[parts[i]], mesh.positions[i]);
        high[parts[i]] = glm::max(high[parts[i]], mesh.positions[i]);
    }
    const auto diagonal = [&](uint32_t vertex) { return glm::distance(low[parts[vertex]], high[parts[vertex]]); };
    float largest = 0;
    for (const glm::uvec3& triangle : mesh.triangles) largest = std::max(largest, diagonal(triangle[0]));
    TriangleMesh kept{mesh.positions, {}};
    for (const glm::uvec3& triangle : mesh.triangles)
        if (diagonal(triangle[0]) >= static_cast<float>(smallest_share) * largest) kept.triangles.push_back(triangle);
    drop_unused_vertices(kept);
    return kept;
}

void drop_unused_vertices(TriangleMesh& mesh) {
    std::vector<uint32_t> renamed(mesh.positions.size(), 0);
    for (const glm::uvec3& triangle : mesh.triangles)
        for (int i = 0; i < 3; ++i) renamed[triangle[i]] = 1;
    uint32_t count = 0;
    for (size_t i = 0; i < renamed.size(); ++i) {
        if (renamed[i] == 0) continue;
        mesh.positions[count] = mesh.positions[i];
        renamed[i] = count++;
    }
    mesh.positions.resize(count);
    for (glm::uvec3& triangle : mesh.triangles)
        for (int i = 0; i < 3; ++i) triangle[i] = renamed[triangle[i]];
}

}  // namespace neuvv::interchange
