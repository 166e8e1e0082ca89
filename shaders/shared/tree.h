// The VOctree's topology as CPU and GPU both see it.
//
// A node covers two octree levels: 4×4×4 cells, numbered in Morton order (z1 y1 x1 z0 y0 x0; the high three bits name
// the 2×2×2 octant). mask_lo/mask_hi hold one bit per occupied cell; its entry in the child array is first_child +
// popcount(mask bits below it). An entry with kLeafBit set names a leaf, else a node. A leaf of the node's upper level
// (twice the cell's edge) fills all eight cells of its octant with the same entry; the device's copy of the child array
// marks those with kWideLeafBit.
#ifndef NEUVV_SHARED_TREE_H
#define NEUVV_SHARED_TREE_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kLeafBit = 0x80000000u;
CONSTEXPR uint kWideLeafBit = 0x40000000u;
CONSTEXPR uint kLeafIndexMask = 0x3fffffffu;
CONSTEXPR uint kMaxNodeLevels = 6u;  // two octree levels each: at most 4096 cells a side

struct TreeNode {
    uint mask_lo;
    uint mask_hi;
    uint first_child;
    uint padding;
};

// The device's grid over the upper levels of the tree, so that a walk need not begin at the root: 4^top_levels cells a
// side, x fastest. A cell is (node to go on from, 0), or where one leaf or nothing fills it (kLeafBit | leaf or
// kNoLeaf, log2 of that cell's side in finest cells).
CONSTEXPR uint kNoLeaf = 0xffffffffu;

#ifdef __cplusplus
constexpr
#endif
    uint
    top_levels(uint node_levels) {
    return node_levels < 3u ? 0u : node_levels > 5u ? 3u : node_levels - 2u;
}

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::TreeNode) == 16);
#endif
#endif
