// The VOctree's topology, as the host and shaders read it.
//
// A node covers two octree levels: 4×4×4 cells, numbered in Morton order (z1 y1 x1 z0 y0 x0; the high three bits are
// the number of the 2×2×2 octant). mask_lo and mask_hi have a bit for each occupied cell, whose entry in the child
// array is first_child + popcount(mask bits below it). An entry with kLeafBit set is the index of a leaf, else of a
// node. A leaf of the node's upper level (twice the cell's edge) fills all eight cells of its octant with the same
// entry; on the device, such a wide octant has only one entry, and the node's `wide` marks it
// (render/volume/slices/walk_tree.h).
#ifndef NEUVV_SHARED_TREE_H
#define NEUVV_SHARED_TREE_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kLeafBit = 0x80000000u;
CONSTEXPR uint kMaxNodeLevels = 6u;  // two octree levels each: at most 4096 cells along each side of the box

struct TreeNode {
    uint mask_lo;
    uint mask_hi;
    uint first_child;
    uint wide;  // on the device, a bit for each wide octant; else 0
};

// The top grid replaces the upper `levels` node levels on the device, so that a walk need not begin at the root. Of the
// box's 4^levels cells along each side it has those between the first and the last that contain leaves, on each axis, x
// fastest. An element has the index of the deepest node of those levels that contains the cell, and from bit
// kTopLevelShift on log4 of the side of that node's cells in finest cells.
CONSTEXPR uint kTopLevelShift = 28u;

// The grid's first and last cell: x in the lowest 10 bits, then y, then z.
struct TopBox {
    uint first;
    uint last;
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::TreeNode) == 16);
#endif
#endif
