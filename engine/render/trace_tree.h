// Trace of a slice tree: the rays of tiles that see it.
#pragma once

#include "render/tile_range.h"

namespace neuvv {

enum class Shading { kPerRay, kPerLeaf };  // SH along each ray, or the colours of record_shade

class TreeTracer {
  public:
    // `entries`: those of the trees, or shaded ones.
    TreeTracer(const Device& device, const Field& field, const SliceTrees& trees, const Buffer& entries,
               const TileRanges& ranges, const RayBatch& rays, Shading shading);

  private:
    friend void record_trace_tree(Commands& commands, const TreeTracer& tracer, uint32_t slice, const RayBatch& rays,
                                  float stop);
    const Field& field_;
    const SliceTrees& trees_;
    const TileRanges& ranges_;
    ComputePass pass_;
    BindingSet set_;
};

// Makes every ray of the batch one that sees nothing.
void record_clear(Commands& commands, const RayBatch& rays);

// Traces the tiles that record_tile_ranges listed; other rays of the batch become clear.
void record_trace_tree(Commands& commands, const TreeTracer& tracer, uint32_t slice, const RayBatch& rays, float stop);

}  // namespace neuvv
