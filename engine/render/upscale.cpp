#include "render/upscale.h"

#include "spirv/upscale.comp.h"

namespace neuvv {

Upscaler::Upscaler(const Device& device, const RayBatch& rays, const Buffer& picture, const TileRanges& ranges,
                   const SetRaster* set)
    : only_(set ? nullptr : &ranges),
      pass_(device, "upscale", upscale_comp, {set ? 0u : 1u, set ? 1u : 0u}),
      set_(pass_, {{kResolveRadiance, &rays.radiance},
                   {kResolveDepth, &rays.depth},
                   {kResolvePicture, &picture},
                   {kResolveTiles, &ranges.picture_list},
                   {kResolveCameras, &rays.cameras},
                   {kResolveSetColour, set ? &set->colour : &rays.radiance},
                   {kResolveSetFront, set ? &set->front : &rays.radiance},
                   {kResolveSetDepth, set ? &set->depth : &rays.depth}}) {}

void record_upscale(Commands& commands, const Upscaler& upscaler, const ViewLayout& layout,
                    const ResolveSettings& settings) {
    const PassScope scope(commands, "upscale");
    const ResolvePush push = resolve_push(layout, settings);
    if (upscaler.only_)
        dispatch_indirect(commands, upscaler.pass_, upscaler.set_, upscaler.only_->picture_count, 0, push);
    else
        dispatch(commands, upscaler.pass_, upscaler.set_, layout.picture_tiles(), push);
    compute_barrier(commands);
}

}  // namespace neuvv
