#include "render/rays/clear_rays.h"

#include "shared/clear_rays.h"
#include "spirv/clear_rays.comp.h"
#include "spirv/covered_list.comp.h"

namespace neuvv::render {

RayClearer::RayClearer(const gpu::Device& device, const RayTarget& given_target)
    : target(given_target),
      list(device, "covered list", covered_list_comp),
      clear(device, "clear rays", device.buffers().fitting(clear_rays_comp, clear_rays_comp_storage)),
      list_set(list, {{kClearCovered, &target.ranges.covered},
                      {kClearList, &target.ranges.list},
                      {kClearCount, &target.ranges.count}}),
      clear_set(clear, {{kClearList, &target.ranges.list},
                        {kClearRadiance, &target.rays.radiance},
                        {kClearDepth, &target.rays.depth}}) {}

void record_clear_rays(gpu::Commands& commands, RayClearer& clearer) {
    const RayBatch& rays = clearer.target.rays;
    if (!clearer.begun) {
        clearer.begun = true;
        record_clear(commands, rays, rays.tile_capacity);
        record_clear_coverage(commands, clearer.target.ranges);
        return;
    }
    const gpu::PassScope scope(commands, "clear");
    record_empty_list(commands, clearer.target.ranges.list, clearer.target.ranges.count, rays.tile_capacity);
    gpu::dispatch(commands, clearer.list, clearer.list_set, rays.tile_capacity, CoveredListPush{rays.tile_capacity});
    gpu::compute_barrier(commands);
    gpu::dispatch_indirect(commands, clearer.clear, clearer.clear_set, clearer.target.ranges.count, 0, nullptr, 0);
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::render
