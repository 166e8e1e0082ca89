// Inspect: where a ray meets a surface, and how many steps the walk through the tree takes until it ends. The walk
// comes to the innermost node around where it is, goes through its leaves until it leaves it or comes to a finer node,
// and so on.
#pragma once

#include "reference/trace.h"

namespace neuvv::reference {

// The nodes of a tree at one time, as walks come to them. A node is so many cells of the box's 4^level /
// 2^levels_above.
struct WalkNode {
    uint32_t level = 0;
    glm::uvec3 place{0};
    bool lives = false;  // a leaf in it has density
};
struct WalkNodes {
    std::vector<WalkNode> nodes;
    std::vector<voctree::LeafPosition> leaves;  // of the tree
    uint32_t levels_above = 0;                  // octree levels by which the root lies above the tree's
    uint32_t grid_levels = 0;                   // nodes of so many levels are found by place, whether they live or not
    glm::uvec3 box_first{0}, box_end{0};        // cells of the grid, 4^grid_levels a side, around all leaves
};
// `pruned`: walks do not meet leaves without density; else all nodes live.
WalkNodes walk_nodes(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices, uint32_t levels_above,
                     uint32_t grid_levels, bool pruned);

struct Inspected {
    uint32_t level = 0;              // of the leaf where opacity · alpha first passes 0.5; 0: it never does
    double distance_m = 0;           // of that place
    double alpha = 0;                // of the whole ray, opacity included
    uint32_t nodes = 0, leaves = 0;  // that the walk came to
};
struct InspectedRay {
    Ray ray;
    Interval range{0, 1e30};  // metres that are walked
    double opacity = 1, stop = 0;
};
Inspected inspect(const voctree::VOctree& tree, const std::vector<LeafSlice>& slices, const WalkNodes& nodes,
                  bool pruned, const InspectedRay& ray);

// sRGB of 0..1, as colour_map.glsl has it.
glm::dvec3 viridis(double at);

}  // namespace neuvv::reference
