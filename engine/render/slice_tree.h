// A slice as a tree of its own, for playing (shared/slice_tree.h): masks pruned to live leaves, σ and SH where a walk finds
// them. Built on the device in one go.
#pragma once

#include "render/slice.h"
#include "shared/slice_tree.h"

namespace neuvv {

struct SliceTree {
    // Room for `capacity` entries: one for each live leaf and each live node but the root. A node that finds none is dead,
    // and its cells are counted in LiveCount::overflow.
    SliceTree(const Device& device, const Field& field, uint32_t entry_capacity);

    uint32_t capacity;
    Buffer nodes;       // per node of the field: live cells, first entry, wide octants
    Buffer entries;     // σ and SH, fp16
    Buffer entry_leaf;  // per entry its leaf, or kNoLeaf
    Buffer count;       // LiveCount of entries
};

// Entries that no slice of the field exceeds.
uint32_t most_entries(const Field& field);

class TreeSlicer {
  public:
    // Field, live leaves (scratch) and tree must outlive it.
    TreeSlicer(const Device& device, const Field& field, const LiveLeaves& live, const SliceTree& tree);

  private:
    friend void record_slice_tree(Commands& commands, const TreeSlicer& slicer, float frame);
    const Field& field_;
    const LiveLeaves& live_;
    const SliceTree& tree_;
    LiveFinder finder_;
    ComputePass nodes_, entries_;
    BindingSet nodes_set_, entries_set_;
};

// Frame 0..frames−1, fractions interpolate (errata 9).
void record_slice_tree(Commands& commands, const TreeSlicer& slicer, float frame);

}  // namespace neuvv
