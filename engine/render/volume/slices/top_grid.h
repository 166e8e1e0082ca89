// The grid over the upper levels of a tree, with which walks begin (shared/tree.h).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "shared/tree.h"

namespace neuvv::render {

// The first and the last cell, along each axis, of a grid's cells that hold leaves.
struct CellBounds {
    glm::uvec3 low{0}, last{0};
    // In the grid of a tree that many octree depths less deep.
    CellBounds coarser(uint32_t depths) const { return {low >> depths, last >> depths}; }
    uint64_t cells() const {
        const glm::u64vec3 size(last - low + 1u);
        return size.x * size.y * size.z;
    }
};

// As shaders have the bounds (shared/tree.h).
inline TopBox top_box(const CellBounds& bounds) {
    const auto packed = [](glm::uvec3 cell) { return cell.x | cell.y << 10 | cell.z << 20; };
    return {packed(bounds.low), packed(bounds.last)};
}

struct TopGrid {
    uint32_t levels = 0;  // node levels that it replaces
    CellBounds bounds;
    std::vector<uint32_t> cells;
};

// The finest grid that takes at most 16 MB. `leaves`: the bounds of all leaves among the finest cells of a tree of
// `node_levels`. Nodes are breadth first, level by level from level_begin on; their positions are
// (x | y << 16, z | level << 16) in cells of their own size.
TopGrid top_grid(uint32_t node_levels, const CellBounds& leaves, const std::vector<uint32_t>& level_begin,
                 const std::vector<glm::uvec2>& node_positions);

}  // namespace neuvv::render
