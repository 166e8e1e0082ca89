// Volume depth: the depth of performers at each texel of the set, for its blended pieces.
#pragma once

#include "render/rays/view_layout.h"
#include "render/set/set_targets.h"
#include "render/volume/trace.h"

namespace neuvv::render {

struct VolumeDepth {
    // Reads the rays, writes set.volume_depth.
    VolumeDepth(const gpu::Device& device, const RayBatch& rays, const SetTargets& set);

    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// To be recorded after the last instance.
void record_volume_depth(gpu::Commands& commands, const VolumeDepth& pass, const ViewLayout& layout);

}  // namespace neuvv::render
