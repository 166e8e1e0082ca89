#include "render/resolve.h"

#include "spirv/resolve.comp.h"

namespace neuvv {

// What is not there is bound to buffers of the same kinds.
Resolver::Resolver(const Device& device, const RayBatch& rays, const Buffer& picture, const TileRanges* only,
                   const SetRaster* set)
    : only_(only),
      pass_(device, "resolve", resolve_comp, {only ? 1u : 0u, set ? 1u : 0u}),
      set_(pass_, {{kResolveRadiance, &rays.radiance},
                   {kResolveDepth, &rays.depth},
                   {kResolvePicture, &picture},
                   {kResolveTiles, only ? &only->picture_list : &rays.tiles},
                   {kResolveCameras, &rays.cameras},
                   {kResolveSetColour, set ? &set->colour : &rays.radiance},
                   {kResolveSetFront, set ? &set->front : &rays.radiance},
                   {kResolveSetDepth, set ? &set->depth : &rays.depth}}) {}

ResolvePush resolve_push(const ViewLayout& layout, const ResolveSettings& settings) {
    return {settings.background,   layout.width,         layout.height,  static_cast<uint32_t>(settings.show),
            settings.depth_near_m, settings.depth_far_m, layout.samples, layout.tiles_across(),
            layout.tiles_down(),   layout.views};
}

void record_resolve(Commands& commands, const Resolver& resolver, const ViewLayout& layout,
                    const ResolveSettings& settings) {
    const PassScope scope(commands, "resolve");
    const ResolvePush push = resolve_push(layout, settings);
    if (resolver.only_)
        dispatch_indirect(commands, resolver.pass_, resolver.set_, resolver.only_->picture_count, 0, push);
    else
        dispatch(commands, resolver.pass_, resolver.set_, layout.picture_tiles(), push);
    compute_barrier(commands);
}

}  // namespace neuvv
