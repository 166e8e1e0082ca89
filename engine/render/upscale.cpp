#include "render/upscale.h"

#include "spirv/upscale.comp.h"

namespace neuvv {

Upscaler::Upscaler(const Device& device, const RayBatch& rays, const Buffer& picture, const TileRanges& only)
    : only_(only),
      pass_(device, "upscale", upscale_comp),
      set_(pass_, {{kResolveRadiance, &rays.radiance},
                   {kResolveDepth, &rays.depth},
                   {kResolvePicture, &picture},
                   {kResolveTiles, &only.picture_list},
                   {kResolveCameras, &rays.cameras}}) {}

void record_upscale(Commands& commands, const Upscaler& upscaler, const ViewLayout& layout,
                    const ResolveSettings& settings) {
    const PassScope scope(commands, "upscale");
    dispatch_indirect(commands, upscaler.pass_, upscaler.set_, upscaler.only_.picture_count, 0,
                      resolve_push(layout, settings));
    compute_barrier(commands);
}

}  // namespace neuvv
