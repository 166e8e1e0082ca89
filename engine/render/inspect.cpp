#include "render/inspect.h"

#include <algorithm>
#include <cassert>

#include "spirv/inspect.comp.h"

namespace neuvv::render {

Inspector::Inspector(const gpu::Device& device, const RayBatch& rays, const gpu::Buffer& picture,
                     std::span<const Field* const> fields)
    : coarsest_(2 * kMaxNodeLevels),
      finest_(1),
      pass_(device, "inspect", inspect_comp, {}),
      set_(pass_, {{kInspectRays, &rays.radiance},
                   {kInspectDepth, &rays.depth},
                   {kInspectCameras, &rays.cameras},
                   {kInspectPicture, &picture}}) {
    for (const Field* field : fields) {
        coarsest_ = std::min(coarsest_, static_cast<float>(field->coarsest_level));
        finest_ = std::max(finest_, static_cast<float>(field->finest_level));
    }
    coarsest_ = std::min(coarsest_, finest_ - 1);  // a single level is bright
}

void record_inspect(gpu::Commands& commands, const Inspector& inspector, const ViewLayout& layout,
                    const ResolveSettings& settings) {
    assert(is_inspection(settings.show) && settings.cost_max > 0);
    const gpu::PassScope scope(commands, inspector.pass_.name());
    const bool level = settings.show == Show::kLevel;
    const InspectPush push{layout.width,
                           layout.height,
                           layout.views,
                           layout.samples,
                           layout.tiles_across(),
                           layout.tiles_down(),
                           level ? 1u : 0u,
                           level ? inspector.coarsest_ : 0,
                           level ? inspector.finest_ : settings.cost_max};
    gpu::dispatch(commands, inspector.pass_, inspector.set_, layout.picture_tiles(), push);
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::render
