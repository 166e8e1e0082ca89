// How the rays and pictures of one frame's views stand in their buffers.
#pragma once

#include "shared/trace.h"

namespace neuvv::render {

// Several views of one frame: pictures of one size, whose tiles stand behind each other, all of one view's first.
struct ViewLayout {
    uint32_t width = 0, height = 0;  // pixels
    uint32_t samples = 1;            // rays a pixel, along each side
    uint32_t views = 1;
    glm::uvec2 rays{0};  // of a view, where they are fewer than pixels (ray_grid.h); else (0, 0)

    bool upscaled() const { return rays.x > 0; }
    uint32_t rays_across() const { return upscaled() ? rays.x : samples * width; }
    uint32_t rays_down() const { return upscaled() ? rays.y : samples * height; }
    uint32_t tiles_across() const { return (rays_across() + kTile - 1) / kTile; }  // of rays
    uint32_t tiles_down() const { return (rays_down() + kTile - 1) / kTile; }
    uint32_t ray_tiles() const { return views * tiles_across() * tiles_down(); }
    uint64_t picture_bytes() const { return uint64_t{4} * width * height * views; }
    uint32_t pictures_across() const { return (width + kTile - 1) / kTile; }  // tiles of a picture
    uint32_t pictures_down() const { return (height + kTile - 1) / kTile; }
    uint32_t picture_tiles() const { return views * pictures_across() * pictures_down(); }
    bool operator==(const ViewLayout&) const = default;
};

}  // namespace neuvv::render
