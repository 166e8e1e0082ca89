// A VOctree's topology as shaders walk it (march.glsl): nodes breadth first, an octant that one leaf fills with a
// single child, and what the slice needs to know of every leaf and node.
//
// It is rooted so that most leaves fill cells, not octants: a node has up to 4×4×4 leaves then, not 2×2×2. Where most
// lie at an odd depth, the tree is the first octant of a root twice as large.
#pragma once

#include <vector>

#include "voctree/voctree.h"

namespace neuvv::render {

struct WalkTree {
    uint32_t node_levels = 1;
    uint32_t scale = 1;                      // the box's edges are so many times the tree's
    uint32_t top_levels = 0;                 // of nodes that the grid stands for
    glm::uvec3 top_low{0}, top_last{0};      // the first and last of its cells, which hold all leaves (shared/tree.h)
    std::vector<TreeNode> nodes;             // level by level, `wide` set
    std::vector<uint32_t> level_begin;       // first node of each level; at the end the number of nodes
    std::vector<uint32_t> children;          // of a node's cells in order, but one alone for a wide octant
    std::vector<uint32_t> top;               // the grid over the upper levels (shared/tree.h)
    std::vector<glm::uvec2> leaf_cells;      // per leaf: (word of the nodes' masks, its bits there)
    std::vector<glm::uvec2> node_cells;      // per node: the same among its parent's; (0, 0) for the root
    std::vector<glm::uvec2> leaf_positions;  // per leaf: (x | y << 16, z | depth << 16), a LeafPosition
    std::vector<glm::uvec2> node_positions;  // per node: the same, in cells of its own size; the depth is its level
    std::vector<glm::uvec2> inner_cells;     // per node: (mask_lo, mask_hi) of the cells that are nodes
};

// The tree must be sound (defect_of_topology(tree) empty).
WalkTree walk_tree(const voctree::VOctree& tree);

}  // namespace neuvv::render
