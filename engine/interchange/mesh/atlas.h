// A texture atlas: the triangles of a mesh laid out in a square without overlaps.
#pragma once

#include <functional>
#include <optional>

#include "interchange/mesh/triangle_mesh.h"

namespace neuvv::interchange {

// A mesh whose vertices are divided where charts of the atlas meet.
struct MappedMesh {
    std::vector<glm::vec3> positions;   // metres
    std::vector<glm::vec3> normals;     // unit
    std::vector<glm::vec2> uvs;         // from the upper left, 0 to 1
    std::vector<glm::uvec3> triangles;  // counter-clockwise from outside
};

// Charts are connected triangles that are projected along one axis, to which none is inclined by more than 60°, and do
// not overlap there. All have the same scale, as large as a square of `side_px` allows, and stay `kAtlasGap_px` apart.
// Nothing where the square is too small for so many charts. Calls `between` some times, which may throw.
constexpr int kAtlasGap_px = 3;
std::optional<MappedMesh> mapped(
    const TriangleMesh& mesh, uint32_t side_px, const std::function<void()>& between = [] {});

// Of each texel of a square of `side_px`: the triangle whose point is nearest to its centre, among those at most 1.5
// texels away; and the barycentric coordinates of that point for the triangle's first two corners.
struct Texel {
    uint32_t triangle = UINT32_MAX;  // none
    glm::vec2 at{0};
};
std::vector<Texel> texels_of(const MappedMesh& mesh, uint32_t side_px);

}  // namespace neuvv::interchange
