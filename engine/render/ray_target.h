// Ray target: the rays of a frame's views, which of their tiles see what, and what ends them.
#pragma once

#include "render/tile_range.h"

namespace neuvv {

struct RayTarget {
    RayTarget(const Device& device, uint32_t cameras, uint32_t ray_tiles, uint32_t picture_tiles,
              const Buffer* depth_of_set = nullptr)
        : rays(device, cameras, ray_tiles),
          ranges(device, rays.tile_capacity, picture_tiles, rays.camera_capacity),
          set_depth(depth_of_set) {}

    RayBatch rays;
    TileRanges ranges;
    // Of the opaque set: metres along the camera's axis (R32_SFLOAT), infinity where there is none, in rows of samples
    // · width texels, views behind each other. Null: rays do not end.
    const Buffer* set_depth;
};

}  // namespace neuvv
