// Trace of an instance by its slice tree, for the tiles that it may cover.
#pragma once

#include "render/volume/intervals.h"
#include "render/volume/slices/slice_tree.h"

namespace neuvv::render {

// SH along each ray, the colours of record_shade, or black where only alpha and depth are needed.
enum class Shading { kPerRay, kPerLeaf, kNone };

struct TreeTracer {
    // `entries` are those of the trees, or shaded ones for Shading::kPerLeaf. `intervals` must not be null where
    // `output` is kIntervals (assert).
    TreeTracer(const gpu::Device& device, const Field& field, const SliceTrees& trees, const gpu::Buffer& entries,
               const RayTarget& target, Shading shading, RayOutput output = RayOutput::kLayer,
               const Intervals* intervals = nullptr);

    const Field& field;
    const SliceTrees& trees;
    const RayTarget& target;
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// The push constants of a slice of the trees.
TracePush tree_push(const Field& field, const SliceTrees& trees, uint32_t slice, const InstanceRays& rays);

// Traces the tiles that record_tile_ranges listed, and combines the result with what is in the target (RayOutput).
void record_trace_tree(gpu::Commands& commands, const TreeTracer& tracer, uint32_t slice, const InstanceRays& rays);

}  // namespace neuvv::render
