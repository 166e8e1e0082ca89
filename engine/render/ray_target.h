// Ray target: the rays of a frame's views, which of their tiles see what, what ends them and what shines on them.
#pragma once

#include "render/tile_range.h"
#include "shared/lights.h"

namespace neuvv::render {

// What a stage does to performers' rays. Null: nothing.
struct SetBuffers {
    // Of the opaque set: metres along the camera's axis (R32_SFLOAT), infinity where there is none, in rows of samples
    // · width texels, views behind each other.
    const gpu::Buffer* set_depth = nullptr;
    // As shadow.glsl reads them; all or none.
    const gpu::Buffer *lights = nullptr, *set_shadows = nullptr, *performer_shadows = nullptr;
};

struct RayTarget {
    RayTarget(const gpu::Device& device, uint32_t cameras, uint32_t ray_tiles, uint32_t image_tiles,
              const SetBuffers& set_buffers = {});

    RayBatch rays;
    TileRanges ranges;
    gpu::Buffer no_lights;
    SetBuffers set_buffers;  // where there is nothing, what may be bound in its place
    bool has_set;
};

}  // namespace neuvv::render
