// Ray target: the rays of a frame's views, the tiles that see instances, and the buffers of a set that end or light
// rays.
#pragma once

#include "render/tile_range.h"
#include "shared/lights.h"

namespace neuvv::render {

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

    RayBatch rays;
    TileRanges ranges;
    gpu::Buffer no_lights;   // bound in place of buffers that do not exist
    SetBuffers set_buffers;  // never null: without a set, other buffers of the same formats, which are not read
};

}  // namespace neuvv::render
