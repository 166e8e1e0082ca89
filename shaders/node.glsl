// A node of the octree (shared/tree.h) in registers: which of its cells live, and where a cell's child stands.
#ifndef NEUVV_NODE_GLSL
#define NEUVV_NODE_GLSL

struct Node {
    uvec2 live;   // (mask_lo, mask_hi): cells that may hold anything
    uvec2 cells;  // those that have a child
    uint first_child;
    uint wide;  // bit for each octant: one leaf fills it, its eight cells share one child
};

bool node_lives(Node node, uint bit) { return ((bit < 32u ? node.live.x : node.live.y) >> (bit & 31u) & 1u) != 0u; }

bool node_wide(Node node, uint bit) { return (node.wide >> (bit >> 3u) & 1u) != 0u; }

// Masks with one bit a child.
uvec2 node_runs(uvec2 cells, uint wide) {
    const uvec2 nibbles = uvec2(wide, wide >> 4u) & 15u;
    return cells & ~((nibbles * 0x204081u & 0x01010101u) * 0xfeu);
}

// Index of a cell's child.
uint node_child(Node node, uint bit) {
    const uvec2 runs = node_runs(node.cells, node.wide);
    const uint at = node_wide(node, bit) ? bit & 56u : bit;
    const uint below = (1u << (at & 31u)) - 1u;
    return node.first_child + (at < 32u ? bitCount(runs.x & below) : bitCount(runs.x) + bitCount(runs.y & below));
}

#endif
