// Slice: a field at one frame as σ and SH per live leaf (errata 7), on the device.
#pragma once

#include "gpu/commands.h"
#include "render/field.h"
#include "shared/slice.h"

namespace neuvv::render {

// The leaves that live at one frame. `capacity` slots; a leaf that finds none renders as empty and is counted in
// LiveCount::overflow.
struct LiveLeaves {
    LiveLeaves(const gpu::Device& device, const Field& field, uint32_t slots);

    uint32_t capacity;
    gpu::Buffer rows;       // BasisRows of the frame
    gpu::Buffer node_live;  // per node: cells with live leaves or nodes
    gpu::Buffer head;       // per leaf (σ bits, slot)
    gpu::Buffer slot_leaf;  // per slot its leaf
    gpu::Buffer live;       // LiveCount
};

// What a slice leaves for the passes after it.
struct Slice : LiveLeaves {
    Slice(const gpu::Device& device, const Field& field, uint32_t slots);

    gpu::Buffer sh;  // per slot (n_max+1)² texels
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

// The rows A_t and B_t alone, which is all that the direct passes need.
void record_rows(gpu::Commands& commands, const LiveFinder& finder, float frame);

// After the rows: σ of the leaves first..end−1, slots of the live ones, and their cells, which are added to what
// node_live holds.
void record_density(gpu::Commands& commands, const LiveFinder& finder, uint32_t first, uint32_t end);

// Frame 0..frames−1, fractions interpolate (errata 9). Ends with a barrier: passes after it may read the slice.
void record_slice(gpu::Commands& commands, const Slicer& slicer, float frame);

}  // namespace neuvv::render
