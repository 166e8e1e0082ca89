// Slice tree: a slice as a tree of its own, for playing (shared/slice_tree.h). Its masks are pruned to live leaves, and
// its entries hold σ and SH in the order in which a walk finds them. The device builds it, unless it comes as one
// (slice_upload.h).
#pragma once

#include "base/remedy.h"
#include "render/volume/slices/paint.h"
#include "render/volume/slices/slice.h"
#include "shared/slice_tree.h"

namespace neuvv::render {

// What new trees are: empty, or undefined until record_empty() was recorded, which has to come before all other use.
enum class TreesBegin { kEmpty, kUndefined };

struct SliceBuffers {
    gpu::Buffer nodes;       // per slice and node of the field: mask of live cells, first entry, wide octants
    gpu::Buffer entries;     // per entry: σ and SH, fp16
    gpu::Buffer entry_leaf;  // per entry: its leaf, or kNoLeaf
    gpu::Buffer counts;      // per slice: LiveCount of entries; all 0 before the slice is built
};

// Several slices of one field, one after the other in the same buffers.
struct SliceTrees : SliceBuffers {
    // Each slice has room for `entry_capacity` entries: one for each live leaf and each live node but the root. Where a
    // node finds no room for its entries the node is left out, and they are counted in LiveCount::overflow. Throws
    // RuntimeFailure where the device cannot dispatch so many entries.
    // It waits for the device, unless the trees are to be emptied later.
    SliceTrees(const gpu::Device& device, const Field& field, uint32_t entry_capacity, uint32_t slices,
               TreesBegin begin = TreesBegin::kEmpty);
    // A single slice that is there already.
    SliceTrees(SliceBuffers built, uint32_t node_count, uint32_t entries);

    uint32_t capacity, slices, node_count;

    uint32_t node_base(uint32_t slice) const { return slice * node_count; }
    uint32_t entry_base(uint32_t slice) const { return slice * capacity; }
};

// Throws RuntimeFailure where the device cannot dispatch so many entries.
void expect_dispatch(const gpu::Device& device, uint32_t entries, Remedy remedy);

// Makes all slices empty, so that their counts are 0 and entries that no node finds room for have no leaf.
void record_empty(gpu::Commands& commands, const SliceTrees& trees);

// The largest number of entries that a slice of the field can have, and the bytes of a slice with room for `entries`.
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

// Builds the slice at time `frame` (0..frames−1; fractions interpolate, errata 9) as the tree number `slice`. `paint`,
// if not null, is bound to these trees. Entries without room are added to LiveCount::overflow.
void record_slice_tree(gpu::Commands& commands, const TreeSlicer& slicer, uint32_t slice, float frame,
                       const SlicePaint* paint = nullptr);

// Builds one part, 0..kSliceParts−1, of the same. The parts are about equal in work and must be recorded in order;
// nothing else may use the live leaves between them.
constexpr uint32_t kSliceParts = 6;
void record_slice_part(gpu::Commands& commands, const TreeSlicer& slicer, uint32_t slice, float frame, uint32_t part,
                       const SlicePaint* paint = nullptr);

}  // namespace neuvv::render
