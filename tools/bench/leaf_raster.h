// Leaf raster: draws a shaded slice tree without rays, to be compared with the trace (neuvv-bench render --rival
// raster). Leaves are projected to tiles, the pairs of a tile and a leaf are sorted, and each tile composites its
// leaves, as SVRaster does.
#pragma once

#include "render/volume/slices/slice_tree.h"
#include "render/volume/trace.h"
#include "tools/bench/pair_sort.h"

namespace neuvv::bench {

struct LeafRasterizer {
    // `shaded`: the entries that render::Shader writes. The references must outlive the rasterizer. Throws
    // RuntimeFailure where the device cannot hold or sort so many pairs.
    LeafRasterizer(const gpu::Device& device, const render::Field& field, const render::SliceTrees& trees,
                   const gpu::Buffer& shaded, const render::RayBatch& rays, uint32_t pair_capacity);

    const render::Field& field;
    const render::SliceTrees& trees;
    const render::RayBatch& rays;
    uint32_t key_bits;
    SortPairs pairs;
    // Per tile: (its first pair, the first after its last) in the buffers of sorted_buffer(key_bits); (0, 0) without
    // pairs.
    gpu::Buffer tile_pairs;
    gpu::Buffer tile_list, tiles_listed;  // tiles that have pairs, and their LiveCount
    PairSorter sorter;
    gpu::ComputePass project, tiles, composite;
    gpu::BindingSet project_set, tiles_set, composite_set;
};

// Draws an image of one of the slices, which is shaded from the camera's eye. `camera` is the camera of the batch's
// tiles, which are the tiles of its image row by row (tiles_of_image).
void record_leaf_raster(gpu::Commands& commands, const LeafRasterizer& rasterizer, uint32_t slice,
                        const ShaderCamera& camera, float stop = render::kStopTransmittance);

// How many pairs the last image has. An image with more pairs than the rasterizer's capacity lacks some of its leaves.
uint32_t pair_count(const gpu::Device& device, const LeafRasterizer& rasterizer);

}  // namespace neuvv::bench
