#include "interchange/mesh/surface_net.h"

#include <algorithm>
#include <array>

namespace neuvv::interchange {

namespace {

constexpr uint32_t kNoVertex = UINT32_MAX;
// Steps of this kind take the steps of leaves away and keep the volume (Taubin, "A signal processing approach to fair
// surface design", 1995).
constexpr int kSmoothings = 2;
constexpr float kInwards = 0.5f, kOutwards = -0.53f;

struct Net {
    TriangleMesh mesh;
    std::vector<glm::ivec3> blocks;              // of each vertex, by the first of its cells
    std::vector<uint32_t> vertex_of;             // of each block, by the index of that cell
    std::vector<std::array<uint32_t, 4>> quads;  // counter-clockwise from outside
};

glm::vec3 centre_of(const Solid& solid, const glm::ivec3& cell) {
    return solid.origin_m + (glm::vec3(cell) + 0.5f) * solid.cell_m;
}

// The mean of where the edges between the centres of a block's cells pass the level; false where none does.
bool place(const Solid& solid, const glm::ivec3& block, glm::vec3& position) {
    int inside = 0;
    for (int i = 0; i < 8; ++i)
        inside += solid.inside(solid.index_of(block + glm::ivec3(i & 1, i >> 1 & 1, i >> 2))) ? 1 : 0;
    if (inside == 0 || inside == 8) return false;
    glm::vec3 sum(0);
    int count = 0;
    for (int axis = 0; axis < 3; ++axis)
        for (int i = 0; i < 4; ++i) {
            glm::ivec3 from = block, to;
            from[(axis + 1) % 3] += i & 1;
            from[(axis + 2) % 3] += i >> 1;
            to = from;
            ++to[axis];
            const size_t a = solid.index_of(from), b = solid.index_of(to);
            if (solid.inside(a) == solid.inside(b)) continue;
            const float part = (solid.level - solid.opacity[a]) / (solid.opacity[b] - solid.opacity[a]);
            sum += glm::mix(centre_of(solid, from), centre_of(solid, to), std::clamp(part, 0.0f, 1.0f));
            ++count;
        }
    position = sum / static_cast<float>(count);
    return true;
}

void add_vertices(const Solid& solid, Net& net) {
    net.vertex_of.assign(solid.opacity.size(), kNoVertex);
    for (int z = 0; z + 1 < solid.size.z; ++z)
        for (int y = 0; y + 1 < solid.size.y; ++y)
            for (int x = 0; x + 1 < solid.size.x; ++x) {
                const glm::ivec3 block(x, y, z);
                glm::vec3 position;
                if (!place(solid, block, position)) continue;
                net.vertex_of[solid.index_of(block)] = static_cast<uint32_t>(net.blocks.size());
                net.blocks.push_back(block);
                net.mesh.positions.push_back(position);
            }
}

// A quad for each face between a cell inside and one outside: around it are the four blocks that have both.
void add_quads(const Solid& solid, Net& net) {
    for (int z = 1; z + 1 < solid.size.z; ++z)
        for (int y = 1; y + 1 < solid.size.y; ++y)
            for (int x = 1; x + 1 < solid.size.x; ++x) {
                const glm::ivec3 cell(x, y, z);
                if (!solid.inside(solid.index_of(cell))) continue;
                for (int axis = 0; axis < 3; ++axis)
                    for (const int side : {0, 1}) {
                        glm::ivec3 beside = cell, u(0), v(0);
                        beside[axis] += side == 1 ? 1 : -1;
                        if (solid.inside(solid.index_of(beside))) continue;
                        u[(axis + 1) % 3] = 1;
                        v[(axis + 2) % 3] = 1;
                        const glm::ivec3 first = glm::min(cell, beside);
                        std::array<uint32_t, 4> quad = {
                            net.vertex_of[solid.index_of(first - u - v)], net.vertex_of[solid.index_of(first - v)],
                            net.vertex_of[solid.index_of(first)], net.vertex_of[solid.index_of(first - u)]};
                        if (side == 0) std::swap(quad[1], quad[3]);
                        net.quads.push_back(quad);
                    }
            }
}

// Moves each vertex by a part of the way to the mean of its neighbours, or away from it, among the centres of its
// cells.
void smooth(const Solid& solid, float part, Net& net) {
    std::vector<glm::vec3> sums(net.blocks.size(), glm::vec3(0));
    std::vector<float> counts(net.blocks.size(), 0);
    for (const std::array<uint32_t, 4>& quad : net.quads)
        for (size_t i = 0; i < 4; ++i)
            for (const size_t other : {(i + 1) % 4, (i + 3) % 4}) {
                sums[quad[i]] += net.mesh.positions[quad[other]];
                counts[quad[i]] += 1;
            }
    for (size_t i = 0; i < sums.size(); ++i)
        net.mesh.positions[i] = glm::clamp(glm::mix(net.mesh.positions[i], sums[i] / counts[i], part),
                                           centre_of(solid, net.blocks[i]), centre_of(solid, net.blocks[i] + 1));
}

}  // namespace

TriangleMesh surface_of(const Solid& solid) {
    Net net;
    add_vertices(solid, net);
    add_quads(solid, net);
    for (int i = 0; i < kSmoothings; ++i) {
        smooth(solid, kInwards, net);
        smooth(solid, kOutwards, net);
    }
    const std::vector<glm::vec3>& at = net.mesh.positions;
    for (const auto& [a, b, c, d] : net.quads) {
        if (glm::distance(at[a], at[c]) < glm::distance(at[b], at[d])) {
            net.mesh.triangles.emplace_back(a, b, c);
            net.mesh.triangles.emplace_back(a, c, d);
        } else {
            net.mesh.triangles.emplace_back(a, b, d);
            net.mesh.triangles.emplace_back(b, c, d);
        }
    }
    return std::move(net.mesh);
}

}  // namespace neuvv::interchange
