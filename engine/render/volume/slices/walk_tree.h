// Walk tree: a VOctree's topology in the form in which shaders walk it (march.glsl). Nodes are in breadth-first order,
// an octant that one leaf fills has a single child, and the slice finds its data of every leaf and node.
#pragma once

#include <vector>

#include "render/volume/slices/walk_shape.h"
#include "voctree/voctree.h"

namespace neuvv::render {

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
