// The layout of the rays and images of a frame's views in their buffers.
#pragma once

#include <algorithm>
#include <vector>

#include "gpu/host_copies.h"
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
    constexpr uint64_t kTileBytes = sizeof(T) * kTilePixels;
    const uint32_t width = layout.rays_across(), height = layout.rays_down(), across = layout.tiles_across();
    const uint64_t tiles = uint64_t{across} * layout.tiles_down(), first = view * tiles;
    std::vector<T> rows(size_t{width} * height);
    const auto place = [&](const T* values, uint64_t tile) {
        const auto left = static_cast<uint32_t>(tile % across * kTile),
                   top = static_cast<uint32_t>(tile / across * kTile);
        for (uint32_t y = 0; y < kTile && top + y < height; ++y)
            std::copy_n(values + y * kTile, std::min<uint32_t>(kTile, width - left),
                        &rows[size_t{top + y} * width + left]);
    };
    gpu::download_pieces(device, rays, (first + tiles) * kTileBytes,
                         [&](const void* piece, uint64_t at, uint64_t bytes) {
                             static_assert(gpu::kStagedPiece % kTileBytes == 0);
                             for (uint64_t i = 0; i < bytes / kTileBytes; ++i)
                                 if (const uint64_t tile = at / kTileBytes + i; tile >= first)
                                     place(static_cast<const T*>(piece) + i * kTilePixels, tile - first);
                         });
    return rows;
}

}  // namespace neuvv::render
