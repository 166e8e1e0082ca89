// Inspect: what the walks of rays were like, as an image: how deep in the octree they met a surface, or what they
// cost.
#pragma once

#include <span>

#include "render/resolve.h"
#include "shared/inspect.h"

namespace neuvv::render {

struct Inspector {
    // `image`: as Resolver's. Levels are shown from the coarsest of the fields' leaves, dark, to the finest, bright.
    Inspector(const gpu::Device& device, const RayBatch& rays, const gpu::Buffer& image,
              std::span<const Field* const> fields);

    float coarsest, finest;
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// Rays that instances were traced into as Into::kInspect, laid out as record_resolve's; is_inspection(settings.show).
// Black where nothing is met, and where no walk took a step; opaque.
void record_inspect(gpu::Commands& commands, const Inspector& inspector, const ViewLayout& layout,
                    const ResolveSettings& settings);

}  // namespace neuvv::render
