// Tile ranges: which tiles of the images may see an instance at all, and between which distances.
#pragma once

#include "render/slice_tree.h"
#include "render/trace.h"
#include "render/view_layout.h"

namespace neuvv::render {

struct TileRanges {
    // At most so many tiles of rays and of images, and cameras of instances.
    TileRanges(const gpu::Device& device, uint32_t ray_tiles, uint32_t image_tiles, uint32_t cameras);

    uint32_t image_tile_capacity;

    gpu::Buffer views;                    // RangeView of each camera of the ray batch, host-mapped
    gpu::Buffer ranges;                   // per tile (bits of the least distance, complement of those of the largest)
    gpu::Buffer list;                     // tiles of rays where an instance may be seen, then kNoTile
    gpu::Buffer count;                    // LiveCount of these
    gpu::Buffer covered;                  // per tile of rays: whether any instance of the frame may be seen there
    gpu::Buffer sharing;                  // and how many of a group
    gpu::Buffer image_list, image_count;  // tiles of the images that such rays add to, as list and count
};

// A camera in its performer's space (shared/slice_tree.h).
RangeView range_view(const ShaderCamera& camera);

// How many pixels the rectangle around a box covers in the image of such a camera, which is so many pixels large; all
// of them where the box reaches behind the eye. 0: none of it can be seen.
double pixels_covered(const RangeView& view, glm::dvec2 image, glm::vec3 box_min, glm::vec3 box_max);

// The coarsest level whose nodes look no larger than half a tile from `eye` (performer's space, metres), where a pixel
// covers 1/focal_pixels of the distance.
uint32_t range_level(const Field& field, glm::vec3 eye, double focal_pixels);

struct TileRanger {
    // Nodes: those of `trees`, or without it of the whole field, as if every leaf lived.
    TileRanger(const gpu::Device& device, const Field& field, const SliceTrees* trees, const RayBatch& rays,
               const TileRanges& ranges);

    const Field& field;
    const SliceTrees* trees;
    const TileRanges& ranges;
    gpu::ComputePass range, list;
    gpu::BindingSet range_set, list_set;
};

// Before the first instance of a frame: no tile has seen anything.
void record_clear_coverage(gpu::Commands& commands, const TileRanges& ranges);

// `first_view`: where the instance's views begin, which are those of its cameras. `level`: nodes of finer levels are
// not looked at, but their parents are as a whole. `slice` is ignored where the ranger has no trees.
// `counted`: the instance is added to those that share its tiles.
void record_tile_ranges(gpu::Commands& commands, const TileRanger& ranger, uint32_t slice, uint32_t first_view,
                        uint32_t level, const ViewLayout& layout, bool counted = false);

// Before the first instance of a group is counted: none shares any tile.
void record_clear_sharing(gpu::Commands& commands, const TileRanges& ranges);

}  // namespace neuvv::render
