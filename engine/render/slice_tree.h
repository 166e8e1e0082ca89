// A slice as a tree of its own, for playing (shared/slice_tree.h): masks pruned to live leaves, σ and SH where a walk
// finds them. Built on the device in one go.
#pragma once

#include "render/paint.h"
#include "render/slice.h"
#include "shared/slice_tree.h"

namespace neuvv::render {

// Slices of one field behind each other.
struct SliceTrees {
    // Room for `capacity` entries a slice: one for each live leaf and each live node but the root. A node that finds
    // none is dead, and its cells are counted in LiveCount::overflow.
    SliceTrees(const gpu::Device& device, const Field& field, uint32_t entry_capacity, uint32_t slices);

    uint32_t capacity, slices, node_count;
    gpu::Buffer nodes;       // per slice and node of the field: live cells, first entry, wide octants
    gpu::Buffer entries;     // σ and SH, fp16
    gpu::Buffer entry_leaf;  // per entry its leaf, or kNoLeaf
    gpu::Buffer counts;      // per slice LiveCount of entries; all 0 before it is built

    uint32_t node_base(uint32_t slice) const { return slice * node_count; }
    uint32_t entry_base(uint32_t slice) const { return slice * capacity; }
};

// Entries that no slice of the field exceeds, and the bytes of a slice with room for so many.
uint32_t max_entries(const Field& field);
uint64_t slice_bytes(const Field& field, uint32_t entries);

struct TreeSlicer {
    // Field, live leaves (scratch) and trees must outlive it.
    TreeSlicer(const gpu::Device& device, const Field& field, const LiveLeaves& live, const SliceTrees& trees);

    const Field& field;
    const LiveLeaves& live;
    const SliceTrees& trees;
    LiveFinder finder;
    gpu::ComputePass nodes, entries;
    gpu::BindingSet nodes_set, entries_set;
};

// `slice`: which of the trees becomes that of the frame, 0..frames−1, fractions interpolate (errata 9); painted, where
// there is paint (bound to these trees). What finds no room is added to what LiveCount::overflow counts already.
void record_slice_tree(gpu::Commands& commands, const TreeSlicer& slicer, uint32_t slice, float frame,
                       const SlicePaint* paint = nullptr);

// The same in parts of about as much work each, 0 to kSliceParts − 1, between which nothing else may use the live
// leaves.
constexpr uint32_t kSliceParts = 6;
void record_slice_part(gpu::Commands& commands, const TreeSlicer& slicer, uint32_t slice, float frame, uint32_t part,
                       const SlicePaint* paint = nullptr);

}  // namespace neuvv::render
