// Ray batch: cameras, the tiles of their images, and what rays through these show.
#pragma once

#include <vector>

#include "gpu/commands.h"
#include "shared/trace.h"
#include "stage/camera.h"

namespace neuvv::render {

// Rays on the device: cameras, their tiles of 8×8 pixels, and the results of tracing them, in tile order.
struct RayBatch {
    // Has room for `cameras` cameras, in memory of this kind, and `tiles` tiles.
    RayBatch(const gpu::Device& device, uint32_t cameras, uint32_t tiles,
             gpu::MemoryKind cameras_in = gpu::MemoryKind::kUpload);

    uint32_t camera_capacity, tile_capacity;
    gpu::Buffer cameras;   // ShaderCamera
    gpu::Buffer tiles;     // Tile, host-mapped
    gpu::Buffer radiance;  // per ray: premultiplied linear RGB and alpha
    gpu::Buffer depth;     // per ray: metres (errata 12)
};

// The camera as shaders take it. `camera` must be enlarged so that each of its pixels is one of the samples × samples
// rays of an image's pixel; ray.glsl distributes them. `samples` is 1 where rays go through the centres of pixels.
ShaderCamera shader_camera(const stage::Camera& camera, uint32_t samples = 1);

// The camera in the space of a performer. `world_from_performer` must be invertible (errata 13).
stage::Camera in_performer(stage::Camera camera, const glm::mat4& world_from_performer);

// All tiles of one image, row by row. `camera` is an index into RayBatch::cameras.
std::vector<Tile> tiles_of_image(uint32_t camera, uint32_t width, uint32_t height);

// Clears the rays of the first `tiles` tiles: transparent, at infinite depth. Frames use record_clear_rays.
void record_clear(gpu::Commands& commands, const RayBatch& rays, uint32_t tiles);

}  // namespace neuvv::render
