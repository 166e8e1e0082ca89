#include "render/ray_target.h"

namespace neuvv::render {

RayTarget::RayTarget(const gpu::Device& device, uint32_t cameras, uint32_t ray_tiles, uint32_t image_tiles,
                     const SetBuffers& given)
    : rays(device, cameras, ray_tiles),
      ranges(device, rays.tile_capacity, image_tiles, rays.camera_capacity),
      no_lights(device, "no lights", sizeof(ShaderLights), gpu::MemoryKind::kDevice),
      set_buffers(given) {
    if (!set_buffers.set_depth) set_buffers.set_depth = &rays.depth;
    if (!set_buffers.lights) set_buffers.lights = &no_lights;
    if (!set_buffers.set_shadows) set_buffers.set_shadows = &rays.depth;
    if (!set_buffers.performer_shadows) set_buffers.performer_shadows = &rays.cameras;
}

}  // namespace neuvv::render
