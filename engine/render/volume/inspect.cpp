#include "render/volume/inspect.h"

#include <algorithm>
#include <cassert>

#include "spirv/inspect.comp.h"

namespace neuvv::render {

Inspector::Inspector(const gpu::Device& device, const RayBatch& rays, const gpu::Buffer& image,
                     std::span<const Field* const> fields)
    : coarsest(2 * kMaxNodeLevels),
      finest(1),
      pass(device, "inspect", device.buffers().fitting(inspect_comp, inspect_comp_storage), {}),
      set(pass, {{kInspectRays, &rays.radiance},
                 {kInspectDepth, &rays.depth},
                 {kInspectCameras, &rays.cameras},
                 {kInspectImage, &image}}) {
    for (const Field* field : fields) {
        coarsest = std::min(coarsest, static_cast<float>(field->coarsest_level));
        finest = std::max(finest, static_cast<float>(field->finest_level));
    }
    coarsest = std::min(coarsest, finest - 1);  // so that a single level is bright
}

void record_inspect(gpu::Commands& commands, const Inspector& inspector, const ViewLayout& layout,
                    const ResolveSettings& settings) {
    assert(is_inspection(settings.show) && settings.cost_max > 0);
    const gpu::PassScope scope(commands, inspector.pass.name());
    const bool level = settings.show == Show::kLevel;
    const InspectPush push{layout.width,
                           layout.height,
                           layout.views,
                           layout.samples,
                           layout.tiles_across(),
                           layout.tiles_down(),
                           level ? 1u : 0u,
                           level ? inspector.coarsest : 0,
                           level ? inspector.finest : settings.cost_max};
    gpu::dispatch_groups(commands, inspector.pass, inspector.set, layout.image_tiles(), push);
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::render
