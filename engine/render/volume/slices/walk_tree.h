// Walk tree: a VOctree's topology in the form in which shaders walk it (march.glsl). Nodes are in breadth-first order,
// an octant that one leaf fills has a single child, and the slice finds its data of every leaf and node.
//
// The root is chosen so that most leaves fill cells, not octants: then a node has up to 4×4×4 leaves, not 2×2×2. Where
// most leaves are at an odd depth, the VOctree becomes the first octant of a root whose box is twice as large.
#pragma once

#include <array>
#include <vector>

#include "render/volume/slices/top_grid.h"
#include "voctree/voctree.h"

namespace neuvv::render {

// How many leaves there are at each octree depth, without the root that a walk tree may have above.
using LeavesOfDepth = std::array<uint32_t, 2 * kMaxNodeLevels + 1>;

// The shape of a tree as walks need it, whatever its leaves hold.
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

struct WalkTree : WalkShape {
    std::vector<TreeNode> nodes;             // level by level, with `wide` set
    std::vector<uint32_t> children;          // of a node's cells in order; a wide octant has only one
    std::vector<glm::uvec2> leaf_positions;  // per leaf: (x | y << 16, z | depth << 16), a LeafPosition
    std::vector<glm::uvec2> leaf_cells;      // per leaf: (word of the nodes' masks, its bits there)
    std::vector<glm::uvec2> node_cells;      // per node: the same in the masks of its parent; (0, 0) for the root
};

// The tree must be sound (defect_of_topology(tree) is empty).
WalkTree walk_tree(const voctree::VOctree& tree);

}  // namespace neuvv::render
