// Slice tree, first half: the nodes of one level, pruned to live cells. It is dispatched once per level, finest level
// first. A node with live cells takes entries for them, writes the entries of its child nodes, and marks its own cell
// in the parent as live.
// Reads the tree's nodes and the live masks; writes nodes, and the entries of child nodes. One thread per node. Bound
// by memory, about 64 bytes per node, and by one atomic addition per workgroup.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/slice_tree.h"

layout(local_size_x = kSliceGroup) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
READ_ARRAY(uvec4, kNodesTree, tree_nodes);
READ_ARRAY(uint, kNodesLinks, tree_links);
READ_ARRAY(uvec2, kNodesCells, node_cells);
layout(binding = kNodesLive, std430) buffer NodeLive { uint node_live[]; };
WRITE_ARRAY(uvec4, kNodesOut, nodes);
WRITE_ARRAY(uvec2, kNodesEntries, entries);
WRITE_ARRAY(uint, kNodesLeaves, entry_leaf);
layout(binding = kNodesCount, std430) buffer Count { LiveCount counts[]; };
layout(push_constant) uniform Push { SliceNodesPush push; };
#include "trace/node.glsl"

shared uint group_count;
shared uint group_first;

// Writes the entries of the child nodes among 32 cells.
void store_child_nodes(Node in_tree, Node in_slice, uint word, uint cells) {
    while (cells != 0u) {
        const uint bit = 32u * word + uint(findLSB(cells));
        cells &= cells - 1u;
        const uint entry = node_child(in_slice, bit);
        const uint child = FETCH(tree_links, int(node_child(in_tree, bit))).x;
        STORE(entries, int(entry * sh_count(kHhDegree)), uvec4(kEntryIsNode, child, 0u, 0u));
        STORE(entry_leaf, int(entry), uvec4(kNoLeaf));
    }
}

void main() {
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    const uint at = group * kSliceGroup + gl_LocalInvocationID.x;
    const uint node = push.first_node + at;
    if (gl_LocalInvocationID.x == 0u) group_count = 0u;
    barrier();

    const uvec4 words = at < push.nodes ? FETCH(tree_nodes, int(node)) : uvec4(0u);
    uvec2 live = at < push.nodes ? uvec2(node_live[2u * node], node_live[2u * node + 1u]) : uvec2(0u);
    const uvec2 runs = node_runs(live, words.w);
    const uint count = bitCount(runs.x) + bitCount(runs.y);
    const uint offset = count > 0u ? atomicAdd(group_count, count) : 0u;
    barrier();
    if (gl_LocalInvocationID.x == 0u && group_count > 0u) {
        group_first = atomicAdd(counts[push.slice].slots, group_count);
        const uint end = min(group_first + group_count, push.capacity);
        atomicMax(counts[push.slice].groups_x, (end + kSliceGroup - 1u) / kSliceGroup);
    }
    barrier();

    if (at >= push.nodes) return;
    const uint first = group_first + offset;
    if (count > 0u && first + count > push.capacity) {
        atomicAdd(counts[push.slice].overflow, count);
        live = uvec2(0u);
    }
    const uint first_entry = push.slice * push.capacity + first;
    STORE(nodes, int(push.node_base + node), uvec4(live, first_entry, words.w));
    if (live == uvec2(0u)) return;
    const uvec2 parent = FETCH(node_cells, int(push.tree_nodes + node)).xy;
    atomicOr(node_live[parent.x], parent.y);
    const uvec2 inner = live & FETCH(node_cells, int(node)).xy;
    const Node in_tree = make_node(live, words.xy, words.z, words.w);
    const Node in_slice = make_node(live, live, first_entry, words.w);
    store_child_nodes(in_tree, in_slice, 0u, inner.x);
    store_child_nodes(in_tree, in_slice, 1u, inner.y);
}
