// The VOctree's topology as CPU and GPU both see it.
//
// A node covers two octree levels: 4×4×4 cells, numbered in Morton order (z1 y1 x1 z0 y0 x0; the high three bits name
// the 2×2×2 octant). mask_lo/mask_hi hold one bit per occupied cell; its entry in the child array is first_child +
// popcount(mask bits below it). An entry with kLeafBit set names a leaf, else a node. A leaf of the node's upper level
// (twice the cell's edge) fills all eight cells of its octant with the same entry; on the device, such a wide octant
// has one entry alone, and the node says which octants are wide (render/walk_tree.h).
#ifndef NEUVV_SHARED_TREE_H
#define NEUVV_SHARED_TREE_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kLeafBit = 0x80000000u;
CONSTEXPR uint kMaxNodeLevels = 6u;  // two octree levels each: at most 4096 cells a side

struct TreeNode {
    uint mask_lo;
    uint mask_hi;
    uint first_child;
    uint wide;  // on the device, a bit for each octant; else 0
};

// The device's grid over the upper levels of the tree, so that a walk need not begin at the root: those of 4^levels
// cells a side that lie between the first and the last with leaves on each axis, x fastest. A cell names the deepest
// node of those levels around it, and above kTopLevelShift a half of log2 of the side of that node's cells in finest
// cells.
CONSTEXPR uint kTopLevelShift = 28u;

// The grid's first and last cell: 10 bits each of x, y, z from the lowest.
struct TopBox {
    uint first;
    uint last;
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::TreeNode) == 16);
#endif
#endif
