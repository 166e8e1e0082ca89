// Triangles without colours: what the steps from a solid to a mesh's file work on.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace neuvv::interchange {

struct TriangleMesh {
    std::vector<glm::vec3> positions;   // metres
    std::vector<glm::uvec3> triangles;  // counter-clockwise from outside
};

// Not normalised: twice the triangle's area long.
glm::vec3 cross_of(const TriangleMesh& mesh, const glm::uvec3& triangle);

// Unit normals of the vertices: those of their triangles, weighted by area.
std::vector<glm::vec3> normals_of(const TriangleMesh& mesh);

// Drops parts, which share no vertex with others, whose box has a diagonal below that share of the largest part's.
TriangleMesh without_small_parts(const TriangleMesh& mesh, double smallest_share);

// Drops vertices that no triangle has. The others keep their order.
void drop_unused_vertices(TriangleMesh& mesh);

}  // namespace neuvv::interchange
