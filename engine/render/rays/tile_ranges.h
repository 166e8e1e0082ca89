// Tile ranges: the tiles that an instance may cover, and the distances between which it may be seen there.
#pragma once

#include "render/rays/ray_batch.h"
#include "shared/slice_tree.h"

namespace neuvv::render {

struct TileRanges {
    // Has room for so many tiles of rays and of images, and for `cameras` cameras, as the ray batch, in memory of this
    // kind.
    TileRanges(const gpu::Device& device, uint32_t ray_tiles, uint32_t image_tiles, uint32_t cameras,
               gpu::MemoryKind views_in = gpu::MemoryKind::kUpload);

    uint32_t image_tile_capacity;

    gpu::Buffer views;    // RangeView of each camera of the ray batch
    gpu::Buffer ranges;   // per tile: (bits of the least distance, complement of the bits of the largest)
    gpu::Buffer list;     // the tiles of rays that the last instance may cover, then kNoTile
    gpu::Buffer count;    // LiveCount of the list
    gpu::Buffer covered;  // per tile of rays: whether any instance of the frame may cover it
    gpu::Buffer sharing;  // per tile of rays: how many instances of a group may cover it
    // List and count of the image tiles to which such rays contribute, or did in the last frame; per image tile,
    // whether such rays do.
    gpu::Buffer image_list, image_count, image_shown;
};

// The projection of a camera in a performer's space (RangeView of shared/slice_tree.h).
RangeView range_view(const ShaderCamera& camera);

// The number of pixels in the rectangle around a box (performer's space, metres) in the view's image, whose size is
// `image` pixels. It is the whole image where the box is partly behind the eye, and 0 where no part of the box is
// visible.
double pixels_covered(const RangeView& view, glm::dvec2 image, glm::vec3 box_min, glm::vec3 box_max);

// No tile is covered. Frames do the same by record_clear_rays.
void record_clear_coverage(gpu::Commands& commands, const TileRanges& ranges);
// Empties a list of tiles, to which a pass will add up to `tiles` of them, and its count.
void record_empty_list(gpu::Commands& commands, const gpu::Buffer& list, const gpu::Buffer& count, uint32_t tiles);

// To be recorded before the first instance of a group is counted: no tile is shared.
void record_clear_sharing(gpu::Commands& commands, const TileRanges& ranges);

}  // namespace neuvv::render
