#include "render/resolve.h"

#include "spirv/resolve.comp.h"

namespace neuvv {

Resolver::Resolver(const Device& device, const RayBatch& rays, const Buffer& picture)
    : pass_(device, "resolve", resolve_comp),
      set_(pass_, {{kResolveRadiance, &rays.radiance}, {kResolveDepth, &rays.depth}, {kResolvePicture, &picture}}) {}

void record_resolve(Commands& commands, const Resolver& resolver, uint32_t width, uint32_t height, uint32_t samples,
                    const ResolveSettings& settings) {
    const PassScope scope(commands, "resolve");
    const uint32_t tiles = ((width + kTile - 1) / kTile) * ((height + kTile - 1) / kTile);
    dispatch(commands, resolver.pass_, resolver.set_, tiles,
             ResolvePush{settings.background, width, height, static_cast<uint32_t>(settings.show),
                         settings.depth_near_m, settings.depth_far_m, samples});
    compute_barrier(commands);
}

}  // namespace neuvv
