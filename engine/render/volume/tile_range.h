// Computes the tile ranges of an instance: projects the boxes of its nodes.
#pragma once

#include "render/rays/tile_ranges.h"
#include "render/rays/view_layout.h"
#include "render/volume/slices/slice_tree.h"

namespace neuvv::render {

// The coarsest level whose nodes look no larger than half a tile from `eye` (performer's space, metres). focal_pixels
// is the focal length in pixels.
uint32_t range_level(const Field& field, glm::vec3 eye, double focal_pixels);

struct TileRanger {
    // Projects the nodes of `trees`, or, where it is null, all nodes of the field, as if every leaf lived.
    TileRanger(const gpu::Device& device, const Field& field, const SliceTrees* trees, const TileRanges& ranges);

    const Field& field;
    const SliceTrees* trees;
    const TileRanges& ranges;
    gpu::ComputePass range, list;
    gpu::BindingSet range_set, list_set;
};

// Computes the tile ranges of an instance. `first_view` is the index of its first RangeView. Nodes of levels finer than
// `level` (range_level) are not projected; their ancestors of that level stand for them. `slice` is ignored where the
// ranger has no trees. With `counted`, the instance is counted in `sharing`.
void record_tile_ranges(gpu::Commands& commands, const TileRanger& ranger, uint32_t slice, uint32_t first_view,
                        uint32_t level, const ViewLayout& layout, bool counted = false);

}  // namespace neuvv::render
