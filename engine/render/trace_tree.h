// Trace of an instance by its slice tree: the rays of tiles that may see it.
#pragma once

#include "render/segments.h"

namespace neuvv::render {

// SH along each ray, the colours of record_shade, or black: for alpha and depth alone
enum class Shading { kPerRay, kPerLeaf, kNone };

// What the walk does without, to measure what it is worth (march.glsl).
struct WalkSteps {
    bool restart = false, from_root = false, coalesce = true;
};

struct TreeTracer {
    // `entries`: those of the trees, or shaded ones. `segments`: not null where these are what rays become.
    TreeTracer(const gpu::Device& device, const Field& field, const SliceTrees& trees, const gpu::Buffer& entries,
               const RayTarget& target, Shading shading, RayOutput output = RayOutput::kLayer,
               const Segments* segments = nullptr, const WalkSteps& steps = {});

    const Field& field;
    const SliceTrees& trees;
    const RayTarget& target;
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// Makes the rays of the batch's first tiles such that see nothing: before the first instance of a frame.
void record_clear(gpu::Commands& commands, const RayBatch& rays, uint32_t tiles);

// Traces the tiles that record_tile_ranges listed, into what stands there.
void record_trace_tree(gpu::Commands& commands, const TreeTracer& tracer, uint32_t slice, const InstanceRays& rays);

}  // namespace neuvv::render
