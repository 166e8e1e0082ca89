// Volume depth: where performers are, for the set's blended pieces.
#pragma once

#include "render/set_raster.h"
#include "render/trace.h"
#include "render/view_layout.h"

namespace neuvv::render {

struct VolumeDepth {
    // Rays → set.volume_depth.
    VolumeDepth(const gpu::Device& device, const RayBatch& rays, const SetRaster& set);

    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// After the last instance.
void record_volume_depth(gpu::Commands& commands, const VolumeDepth& pass, const ViewLayout& layout);

}  // namespace neuvv::render
