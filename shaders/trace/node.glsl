// A node of the octree (shared/tree.h) in registers: its live cells, and the indices of its cells' children.
#ifndef NEUVV_NODE_GLSL
#define NEUVV_NODE_GLSL

struct Node {
    uvec2 live;   // (mask_lo, mask_hi) of the cells that may contain live leaves
    uint wide;    // a bit for each octant that one leaf fills, so that its eight cells share one child
    uvec2 runs;   // node_runs of the cells that have a child
    uvec2 first;  // the index of the first child of each half
};

// A mask of cells with the first cell alone of each wide octant, so that each child has one bit.
uvec2 node_runs(uvec2 cells, uint wide) {
    const uvec2 nibbles = uvec2(wide, wide >> 4u) & 15u;
    return cells & ~((nibbles * 0x204081u & 0x01010101u) * 0xfeu);
}

// `cells`: the mask of the cells that have a child. A walk asks for several children of a node, so what they share is
// computed once.
Node make_node(uvec2 live, uvec2 cells, uint first_child, uint wide) {
    const uvec2 runs = node_runs(cells, wide);
    return Node(live, wide, runs, uvec2(first_child, first_child + bitCount(runs.x)));
}

bool node_lives(Node node, uint bit) { return ((bit < 32u ? node.live.x : node.live.y) >> (bit & 31u) & 1u) != 0u; }

bool node_wide(Node node, uint bit) { return (node.wide >> (bit >> 3u) & 1u) != 0u; }

// The index of a cell's child.
uint node_child(Node node, uint bit) {
    const uint at = node_wide(node, bit) ? bit & 24u : bit & 31u;
    const uint below = (1u << at) - 1u;
    return (bit < 32u ? node.first.x : node.first.y) + bitCount((bit < 32u ? node.runs.x : node.runs.y) & below);
}

#endif
