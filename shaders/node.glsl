// A node of the octree (shared/tree.h) in registers: its live cells, and the indices of its cells' children.
#ifndef NEUVV_NODE_GLSL
#define NEUVV_NODE_GLSL

struct Node {
    uvec2 live;   // (mask_lo, mask_hi) of the cells that may contain live leaves
    uvec2 cells;  // the mask of the cells that have a child
    uint first_child;
    uint wide;  // a bit for each octant that one leaf fills, so that its eight cells share one child
};

bool node_lives(Node node, uint bit) { return ((bit < 32u ? node.live.x : node.live.y) >> (bit & 31u) & 1u) != 0u; }

bool node_wide(Node node, uint bit) { return (node.wide >> (bit >> 3u) & 1u) != 0u; }

// A mask of cells with the first cell alone of each wide octant, so that each child has one bit.
uvec2 node_runs(uvec2 cells, uint wide) {
    const uvec2 nibbles = uvec2(wide, wide >> 4u) & 15u;
    return cells & ~((nibbles * 0x204081u & 0x01010101u) * 0xfeu);
}

// The index of a cell's child.
uint node_child(Node node, uint bit) {
    const uvec2 runs = node_runs(node.cells, node.wide);
    const uint at = node_wide(node, bit) ? bit & 56u : bit;
    const uint below = (1u << (at & 31u)) - 1u;
    return node.first_child + (at < 32u ? bitCount(runs.x & below) : bitCount(runs.x) + bitCount(runs.y & below));
}

#endif
