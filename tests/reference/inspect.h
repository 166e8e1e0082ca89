// Inspect: where a ray meets a surface, and how many steps its walk through the tree takes until it ends. The walk
// enters the innermost node around its position, goes through the leaves of this node until it leaves the node or meets
// a finer one, and repeats.
#pragma once

#include "reference/trace.h"

namespace neuvv::reference {

// A node of a tree at one time, as walks meet it. The tree's box has 4^level / 2^levels_above nodes along each side.
struct WalkNode {
    uint32_t level = 0;
    glm::uvec3 cell{0};  // the node's position among the nodes of its level
    bool lives = false;  // a leaf in it is live
};
struct WalkNodes {
    std::vector<WalkNode> nodes;
    std::vector<voctree::LeafPosition> leaves;  // of the tree
    uint32_t levels_above = 0;                  // octree levels by which the walk's root lies above the tree's
    uint32_t grid_levels = 0;             // nodes of the upper grid_levels levels are met whether they live or not
    glm::uvec3 box_first{0}, box_end{0};  // cells of the grid, 4^grid_levels along each side, around all leaves
};
// With `pruned`, walks do not meet leaves with σ = 0; otherwise all nodes live.
WalkNodes walk_nodes(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices, uint32_t levels_above,
                     uint32_t grid_levels, bool pruned);

struct Inspected {
    uint32_t level = 0;              // of the leaf where opacity · alpha first reaches 0.5; 0: nowhere
    double distance_m = 0;           // the distance along the ray where it does
    double alpha = 0;                // of the whole ray, opacity included
    uint32_t nodes = 0, leaves = 0;  // the numbers of nodes and leaves that the walk met
};
struct InspectedRay {
    Ray ray;
    Interval range{0, 1e30};  // the part of the ray that is walked, metres
    double opacity = 1, stop = 0;
};
Inspected inspect(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices, const WalkNodes& nodes,
                  bool pruned, const InspectedRay& ray);

// The sRGB colour of a number of 0..1, as in colour_map.glsl.
glm::dvec3 viridis(double at);

}  // namespace neuvv::reference
