#include "render/rays/ray_target.h"

#include <algorithm>

namespace neuvv::render {

RayTarget::RayTarget(const gpu::Device& device, uint32_t camera_count, uint32_t ray_tiles, uint32_t image_tiles,
                     const SetBuffers& given)
    : cameras(camera_count),
      views(camera_count),
      rays(device, camera_count, ray_tiles, gpu::MemoryKind::kDevice),
      ranges(device, rays.tile_capacity, image_tiles, rays.camera_capacity, gpu::MemoryKind::kDevice),
      no_lights(device, "no lights", sizeof(ShaderLights), gpu::MemoryKind::kDevice),
      set_buffers(given) {
    if (!set_buffers.set_depth) set_buffers.set_depth = &rays.depth;
    if (!set_buffers.lights) set_buffers.lights = &no_lights;
    if (!set_buffers.set_shadows) set_buffers.set_shadows = &rays.depth;
    if (!set_buffers.performer_shadows) set_buffers.performer_shadows = &rays.cameras;
}

void RayTarget::set_camera(uint32_t index, const ShaderCamera& camera, const RangeView& view) {
    cameras[index] = camera;
    views[index] = view;
    used_cameras = std::max(used_cameras, index + 1);
}

void record_cameras(gpu::Commands& commands, const RayTarget& target) {
    gpu::update(commands, target.rays.cameras, target.cameras.data(), sizeof(ShaderCamera) * target.used_cameras);
    gpu::update(commands, target.ranges.views, target.views.data(), sizeof(RangeView) * target.used_cameras);
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::render
