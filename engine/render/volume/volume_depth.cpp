#include "render/volume/volume_depth.h"

#include "shared/volume_depth.h"
#include "spirv/volume_depth.comp.h"

namespace neuvv::render {

VolumeDepth::VolumeDepth(const gpu::Device& device, const RayBatch& rays, const SetTargets& given_set)
    : pass(device, "volume depth", device.buffers().fitting(volume_depth_comp, volume_depth_comp_storage)),
      set(pass, {{kVolumeRadiance, &rays.radiance},
                 {kVolumeDepth, &rays.depth},
                 {kVolumeCameras, &rays.cameras},
                 {kVolumeOut, &given_set.volume_depth}}) {}

void record_volume_depth(gpu::Commands& commands, const VolumeDepth& pass, const ViewLayout& layout) {
    const gpu::PassScope scope(commands, "volume depth");
    const uint32_t width = layout.samples * layout.width, height = layout.samples * layout.height;
    const uint64_t texels = uint64_t{layout.views} * width * height;
    gpu::dispatch(commands, pass.pass, pass.set, texels,
                  VolumeDepthPush{width, height, layout.views, layout.tiles_across(), layout.tiles_down()});
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::render
