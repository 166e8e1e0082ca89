// Trace of an instance by its slice tree, for the tiles that it may cover.
#pragma once

#include "render/volume/intervals.h"
#include "render/volume/slices/slice_tree.h"

namespace neuvv::render {

// SH along each ray, the colours of record_shade, or black where only alpha and depth are needed.
enum class Shading { kPerRay, kPerLeaf, kNone };

// Variants of the walk (march.glsl), by which the benchmark measures its optimisations. The defaults are the fastest
// walk.
struct WalkSteps {
    bool restart = false;    // true: reads the node again at every step
    bool from_root = false;  // true: descends from the root, not from the grid
    bool coalesce = true;    // false: steps over each empty cell by itself
};

struct TreeTracer {
    // `entries` are those of the trees, or shaded ones for Shading::kPerLeaf. `intervals` must not be null where
    // `output` is kIntervals (assert).
    TreeTracer(const gpu::Device& device, const Field& field, const SliceTrees& trees, const gpu::Buffer& entries,
               const RayTarget& target, Shading shading, RayOutput output = RayOutput::kLayer,
               const Intervals* intervals = nullptr, const WalkSteps& steps = {});

    const Field& field;
    const SliceTrees& trees;
    const RayTarget& target;
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// Traces the tiles that record_tile_ranges listed, and combines the result with what is in the target (RayOutput).
void record_trace_tree(gpu::Commands& commands, const TreeTracer& tracer, uint32_t slice, const InstanceRays& rays);

}  // namespace neuvv::render
