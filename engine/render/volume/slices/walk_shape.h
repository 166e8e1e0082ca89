// The shape of a tree as shaders walk it (march.glsl), whatever its leaves hold.
//
// The root is chosen so that most leaves fill cells, not octants: then a node has up to 4×4×4 leaves, not 2×2×2. Where
// most leaves are at an odd depth, the tree becomes the first octant of a root whose box is twice as large.
#pragma once

#include <array>
#include <vector>

#include "render/volume/slices/top_grid.h"
#include "shared/tree.h"

namespace neuvv::render {

// How many leaves there are at each octree depth, without the root that a walk tree may have above.
using LeavesOfDepth = std::array<uint32_t, 2 * kMaxNodeLevels + 1>;

struct WalkShape {
    LeavesOfDepth leaves{};
    uint32_t node_levels = 1;
    uint32_t scale = 1;  // the edges of its box relative to those of the box that was given: 1 or 2
    TopGrid top;
    std::vector<uint32_t> level_begin;       // the first node of each level, then the number of nodes
    std::vector<glm::uvec2> node_positions;  // per node: (x | y << 16, z | level << 16), in cells of its own size
    std::vector<glm::uvec2> inner_cells;     // per node: (mask_lo, mask_hi) of the cells that are nodes
};

// Sets the leaves' counts, and the root that they ask for: node_levels and scale.
void set_root(WalkShape& shape, const LeavesOfDepth& leaves);

}  // namespace neuvv::render
