#include "render/rays/resolve.h"

#include <cassert>

#include "spirv/resolve.comp.h"
#include "spirv/upscale.comp.h"

namespace neuvv::render {

// Bindings of buffers that do not exist get other buffers of the same formats.
Resolver::Resolver(const gpu::Device& device, RaysPerPixel rays_per_pixel, const RayBatch& rays,
                   const gpu::Buffer& image, const TileRanges* given_listed, const SetTargets* given_set)
    : listed(given_listed),
      pass(device, rays_per_pixel == RaysPerPixel::kFewer ? "upscale" : "resolve",
           rays_per_pixel == RaysPerPixel::kFewer ? device.buffers().fitting(upscale_comp, upscale_comp_storage)
                                                  : device.buffers().fitting(resolve_comp, resolve_comp_storage),
           {listed ? 1u : 0u, given_set ? 1u : 0u}),
      set(pass, {{kResolveRadiance, &rays.radiance},
                 {kResolveDepth, &rays.depth},
                 {kResolveImage, &image},
                 {kResolveTiles, listed ? &listed->image_list : &rays.tiles},
                 {kResolveCameras, &rays.cameras},
                 {kResolveSetColour, given_set ? &given_set->colour : &rays.radiance},
                 {kResolveSetFront, given_set ? &given_set->front : &rays.radiance},
                 {kResolveSetDepth, given_set ? &given_set->depth : &rays.depth}}) {}

void record_resolve(gpu::Commands& commands, const Resolver& resolver, const ViewLayout& layout,
                    const ResolveSettings& settings) {
    assert(!is_inspection(settings.show));
    const gpu::PassScope scope(commands, resolver.pass.name());
    const ResolvePush push{
        settings.background,   layout.width,         layout.height,  static_cast<uint32_t>(settings.show),
        settings.depth_near_m, settings.depth_far_m, layout.samples, layout.tiles_across(),
        layout.tiles_down(),   layout.views};
    if (resolver.listed)
        gpu::dispatch_indirect(commands, resolver.pass, resolver.set, resolver.listed->image_count, 0, push);
    else
        gpu::dispatch_groups(commands, resolver.pass, resolver.set, layout.image_tiles(), push);
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::render
