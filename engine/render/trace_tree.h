// Trace of an instance by its slice tree: the rays of tiles that may see it.
#pragma once

#include "render/tile_range.h"

namespace neuvv {

enum class Shading { kPerRay, kPerLeaf };  // SH along each ray, or the colours of record_shade

// What the walk does without, to measure what it is worth (march.glsl).
struct WalkSteps {
    bool restart = false, from_root = false, coalesce = true;
};

class TreeTracer {
  public:
    // `entries`: those of the trees, or shaded ones.
    TreeTracer(const Device& device, const Field& field, const SliceTrees& trees, const Buffer& entries,
               const TileRanges& ranges, const RayBatch& rays, Shading shading, const WalkSteps& steps = {});

  private:
    friend void record_trace_tree(Commands& commands, const TreeTracer& tracer, uint32_t slice, uint32_t first_camera,
                                  float stop);
    const Field& field_;
    const SliceTrees& trees_;
    const TileRanges& ranges_;
    ComputePass pass_;
    BindingSet set_;
};

// Makes the rays of the batch's first tiles such that see nothing: before the first instance of a frame.
void record_clear(Commands& commands, const RayBatch& rays, uint32_t tiles);

// Traces the tiles that record_tile_ranges listed, into what stands there (errata 11). `first_camera`: the instance's
// in the batch, one a view; the batch's first are those of the world.
void record_trace_tree(Commands& commands, const TreeTracer& tracer, uint32_t slice, uint32_t first_camera, float stop);

}  // namespace neuvv
