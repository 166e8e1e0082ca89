// Inspect: what the walks of rays were like, as an image: how deep in the octree they met a surface, or what they
// cost.
#pragma once

#include <span>

#include "render/rays/resolve.h"
#include "render/volume/slices/field.h"
#include "shared/inspect.h"

namespace neuvv::render {

struct Inspector {
    // `image`: as for Resolver. The colour map goes from dark at the coarsest level of the fields' leaves to bright at
    // the finest.
    Inspector(const gpu::Device& device, const RayBatch& rays, const gpu::Buffer& image,
              std::span<const Field* const> fields);

    float coarsest, finest;
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// Makes an opaque image of rays to which instances were traced as RayOutput::kInspect, with the layout of
// record_resolve. Pixels are black where rays meet no surface, or where no walk took a step.
// is_inspection(settings.show) must hold (assert).
void record_inspect(gpu::Commands& commands, const Inspector& inspector, const ViewLayout& layout,
                    const ResolveSettings& settings);

}  // namespace neuvv::render
