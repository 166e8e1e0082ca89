// Ray target: the rays of a frame's views, the tiles that see instances, and the buffers of a set that end or light
// rays.
#pragma once

#include "render/rays/tile_ranges.h"
#include "shared/lights.h"

namespace neuvv::render {

// Images that may be under way at once: the host records one while the device draws the one before. Each has a slot,
// 0..kImagesUnderWay−1, for what the host reads of it.
constexpr uint32_t kImagesUnderWay = 2;

// The buffers of a set that performers' rays read. Null: there is no set.
struct SetBuffers {
    // The depth of the opaque set: metres along the camera's axis (R32_SFLOAT), infinity where there is no set. Rows of
    // samples · width texels, views one after the other.
    const gpu::Buffer* set_depth = nullptr;
    // The lights and their shadow maps, as shadow.glsl reads them; either all or none.
    const gpu::Buffer *lights = nullptr, *set_shadows = nullptr, *performer_shadows = nullptr;
};

struct RayTarget {
    // Has room for `cameras` cameras (of the views, in the world and in each instance's space) and for so many tiles of
    // rays and of images.
    RayTarget(const gpu::Device& device, uint32_t cameras, uint32_t ray_tiles, uint32_t image_tiles,
              const SetBuffers& set_buffers = {});

    // Sets a camera, and its view for tile ranges, on the host.
    void set_camera(uint32_t index, const ShaderCamera& camera, const RangeView& view = {});

    // The cameras as the next images will have them, and their RangeViews. record_cameras brings them to `rays` and
    // `ranges`.
    std::vector<ShaderCamera> cameras;
    std::vector<RangeView> views;
    uint32_t used_cameras = 0;  // those behind the last that was set stay as they are

    RayBatch rays;
    TileRanges ranges;
    gpu::Buffer no_lights;   // bound in place of buffers that do not exist
    SetBuffers set_buffers;  // never null: without a set, other buffers of the same formats, which are not read
};

// To be recorded before the passes of an image. The cameras travel in the commands, as images that are still under way
// read those of their own.
void record_cameras(gpu::Commands& commands, const RayTarget& target);

}  // namespace neuvv::render
