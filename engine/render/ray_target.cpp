#include "render/ray_target.h"

namespace neuvv::render {

RayTarget::RayTarget(const gpu::Device& device, uint32_t cameras, uint32_t ray_tiles, uint32_t image_tiles,
                     const Surroundings& given)
    : rays(device, cameras, ray_tiles),
      ranges(device, rays.tile_capacity, image_tiles, rays.camera_capacity),
      no_lights(device, "no lights", sizeof(ShaderLights), gpu::MemoryKind::kDevice),
      around(given),
      has_set(given.set_depth != nullptr) {
    if (!around.set_depth) around.set_depth = &rays.depth;
    if (!around.lights) around.lights = &no_lights;
    if (!around.set_shadows) around.set_shadows = &rays.depth;
    if (!around.performer_shadows) around.performer_shadows = &rays.depth;
}

}  // namespace neuvv::render
