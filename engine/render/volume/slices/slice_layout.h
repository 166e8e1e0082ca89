// Where the leaves of a slice lie in the slice tree that is made of them.
#pragma once

#include <span>

#include "render/volume/slices/walk_shape.h"
#include "shared/slice_tree.h"
#include "stream/codec/quantised_slice.h"

namespace neuvv::render {

// A slice tree (shared/slice_tree.h) without the entries of its leaves. Leaves without opacity have none, and nodes
// without leaves are left out.
struct SliceLayout : WalkShape {
    struct NodeEntry {
        uint32_t entry, node;
    };
    std::vector<glm::uvec4> nodes;         // breadth first
    std::vector<NodeEntry> node_entries;   // of all nodes but the root
    std::vector<uint32_t> entry_of_leaf;   // from the first entry of its level on; kNoLeaf: it has none
    std::vector<uint32_t> entries_before;  // by a leaf's depth in the slice: the first entry of its level
    uint32_t entries = 0;                  // of all leaves and nodes
    // Of a leaf that has one: `of_level` is its entry_of_leaf.
    uint32_t entry_of(uint32_t depth, uint32_t of_level) const { return entries_before[depth] + of_level; }
};

// The leaves must be in order, at depths from 1 to the slice's. `positions` receives for each leaf of the slice (x | y
// << 16, z | depth << 16), and is not read. Takes about 12 ns a leaf, on one thread, because each level's nodes and
// entries lie in the order in which the leaves come.
SliceLayout slice_layout(const stream::QuantisedSlice& slice, std::span<glm::uvec2> positions);

}  // namespace neuvv::render
