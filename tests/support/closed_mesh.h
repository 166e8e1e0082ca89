// Whether a mesh is a closed manifold, and what it encloses.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "interchange/mesh/triangle_mesh.h"
#include "slice/cell_code.h"
#include "slice/slice.h"

namespace neuvv::test {

// Leaves of one depth in a box of a metre, where `inside` says so of their centres.
inline void add_leaves(slice::Slice& volume, uint32_t depth, float sigma,
                       const std::function<bool(glm::vec3)>& inside) {
    const auto side = 1u << depth;
    for (uint32_t z = 0; z < side; ++z)
        for (uint32_t y = 0; y < side; ++y)
            for (uint32_t x = 0; x < side; ++x)
                if (inside((glm::vec3(x, y, z) + 0.5f) / static_cast<float>(side)))
                    volume.leaves.push_back(
                        {slice::code_of({x, y, z}) << 3 * (volume.depth - depth), depth, sigma, {}, 0});
    std::sort(volume.leaves.begin(), volume.leaves.end(), [](const auto& a, const auto& b) { return a.cell < b.cell; });
}

inline slice::Slice volume_of(uint32_t depth, float sigma, const std::function<bool(glm::vec3)>& inside) {
    slice::Slice volume;
    volume.depth = depth;
    add_leaves(volume, depth, sigma, inside);
    return volume;
}

// Each edge has one triangle on each side, the triangles around each vertex are one ring, and there is no other vertex.
// Returns the Euler number.
inline int expect_closed(const interchange::TriangleMesh& mesh) {
    std::map<std::pair<uint32_t, uint32_t>, int> edges;
    std::vector<std::map<uint32_t, uint32_t>> rings(mesh.positions.size());  // from the second corner to the third
    for (const glm::uvec3& triangle : mesh.triangles)
        for (int k = 0; k < 3; ++k) {
            const uint32_t a = triangle[k], b = triangle[(k + 1) % 3], c = triangle[(k + 2) % 3];
            ++edges[{a, b}];
            rings[a][b] = c;
        }
    int wrong_edges = 0, wrong_rings = 0;
    for (const auto& [edge, count] : edges) {
        const auto other = edges.find({edge.second, edge.first});
        if (count != 1 || other == edges.end() || other->second != 1) ++wrong_edges;
    }
    for (const std::map<uint32_t, uint32_t>& ring : rings) {
        size_t length = 0;
        if (!ring.empty()) {
            uint32_t at = ring.begin()->first;
            do {
                const auto next = ring.find(at);
                if (next == ring.end()) break;
                at = next->second;
                ++length;
            } while (at != ring.begin()->first && length <= ring.size());
        }
        if (length == 0 || length != ring.size()) ++wrong_rings;
    }
    EXPECT_EQ(wrong_edges, 0);
    EXPECT_EQ(wrong_rings, 0);
    return static_cast<int>(mesh.positions.size()) - static_cast<int>(edges.size() / 2) +
           static_cast<int>(mesh.triangles.size());
}

// By the divergence theorem: positive where triangles are counter-clockwise from outside.
inline double enclosed_m3(const interchange::TriangleMesh& mesh) {
    double sum = 0;
    for (const glm::uvec3& triangle : mesh.triangles) {
        const glm::dvec3 a(mesh.positions[triangle[0]]), b(mesh.positions[triangle[1]]), c(mesh.positions[triangle[2]]);
        sum += glm::dot(a, glm::cross(b, c)) / 6;
    }
    return sum;
}

}  // namespace neuvv::test
