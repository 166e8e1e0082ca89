// Slice: a field at one time of its clip, as σ and SH of each live leaf (errata 7), on the device.
#pragma once

#include "gpu/commands.h"
#include "render/volume/slices/field.h"
#include "shared/slice.h"

namespace neuvv::render {

// The leaves that live at one time. There are `capacity` slots; a live leaf without a slot renders as empty and is
// counted in LiveCount::overflow.
struct LiveLeaves {
    // Throws RuntimeFailure where the device cannot dispatch so many slots.
    LiveLeaves(const gpu::Device& device, const Field& field, uint32_t slots);

    uint32_t capacity;
    gpu::Buffer rows;       // BasisRows of the time
    gpu::Buffer node_live;  // per node: the mask of its cells with live leaves or nodes
    gpu::Buffer head;       // per leaf: (bits of σ, slot)
    gpu::Buffer slot_leaf;  // per slot: its leaf
    gpu::Buffer live;       // LiveCount
};

// The results of a slice, for the passes after it.
struct Slice : LiveLeaves {
    Slice(const gpu::Device& device, const Field& field, uint32_t slots);

    gpu::Buffer sh;  // per slot: (n_max+1)² texels of RGB coefficients
};

struct LiveFinder {
    // Field and live leaves must outlive it.
    LiveFinder(const gpu::Device& device, const Field& field, const LiveLeaves& live);

    const Field& field;
    const LiveLeaves& live;
    gpu::ComputePass rows, density;
    gpu::BindingSet rows_set, density_set;
};

struct Slicer {
    // Field and slice must outlive it.
    Slicer(const gpu::Device& device, const Field& field, const Slice& slice);

    const Field& field;
    const Slice& slice;
    LiveFinder finder;
    gpu::ComputePass colour;
    gpu::BindingSet colour_set;
};

// Computes only the rows A_t and B_t, which is all that the direct passes need.
void record_rows(gpu::Commands& commands, const LiveFinder& finder, float frame);

// To be recorded after the rows: computes σ of the leaves first..end−1, gives slots to the live ones, and adds the bits
// of their cells to node_live.
void record_density(gpu::Commands& commands, const LiveFinder& finder, uint32_t first, uint32_t end);

// `frame` is 0..frames−1; fractions interpolate between frames (errata 9). Ends with a barrier: later passes may read
// the slice.
void record_slice(gpu::Commands& commands, const Slicer& slicer, float frame);

}  // namespace neuvv::render
