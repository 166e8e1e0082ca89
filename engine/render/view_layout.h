// The layout of the rays and images of a frame's views in their buffers.
#pragma once

#include <vector>

#include "gpu/commands.h"
#include "shared/trace.h"

namespace neuvv::render {

// The views of a frame have images of the same size. Their tiles are one after the other in the buffers, view by view.
struct ViewLayout {
    uint32_t width = 0, height = 0;  // pixels
    uint32_t samples = 1;            // rays per pixel along each side
    uint32_t views = 1;
    glm::uvec2 rays{0};  // of a view where they are fewer than pixels (ray_grid.h), else (0, 0)

    bool upscaled() const { return rays.x > 0; }
    uint32_t rays_across() const { return upscaled() ? rays.x : samples * width; }
    uint32_t rays_down() const { return upscaled() ? rays.y : samples * height; }
    uint32_t tiles_across() const { return (rays_across() + kTile - 1) / kTile; }  // of rays
    uint32_t tiles_down() const { return (rays_down() + kTile - 1) / kTile; }
    uint32_t ray_tiles() const { return views * tiles_across() * tiles_down(); }
    uint64_t image_bytes() const { return uint64_t{4} * width * height * views; }
    uint32_t images_across() const { return (width + kTile - 1) / kTile; }  // tiles of an image
    uint32_t images_down() const { return (height + kTile - 1) / kTile; }
    uint32_t image_tiles() const { return views * images_across() * images_down(); }
    bool operator==(const ViewLayout&) const = default;
};

// The number of ray tiles of all views, without upscaling. Throws RuntimeFailure where the device cannot address so
// many rays.
uint32_t checked_ray_tiles(const gpu::Device& device, const ViewLayout& layout);

// Downloads the values of one view's rays, and reorders them from tiles to rows.
template <typename T>
std::vector<T> rows_of_view(const gpu::Device& device, const gpu::Buffer& rays, const ViewLayout& layout,
                            uint32_t view) {
    std::vector<T> tiles(size_t{layout.ray_tiles()} * kTilePixels);
    gpu::download(device, rays, tiles.data(), tiles.size() * sizeof(T));
    const uint32_t width = layout.rays_across(), height = layout.rays_down();
    const size_t first_tile = size_t{view} * layout.tiles_across() * layout.tiles_down();
    std::vector<T> rows(size_t{width} * height);
    for (uint32_t y = 0; y < height; y++)
        for (uint32_t x = 0; x < width; x++) {
            const size_t tile = first_tile + size_t{y / kTile} * layout.tiles_across() + x / kTile;
            rows[size_t{y} * width + x] = tiles[tile * kTilePixels + y % kTile * kTile + x % kTile];
        }
    return rows;
}

}  // namespace neuvv::render
