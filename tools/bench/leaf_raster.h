// Leaf raster: a shaded slice tree as sparse voxels in place of a trace, for comparison (neuvv-bench render --rival
// raster). Leaves are projected to tiles, pairs of both sorted, and composited tile by tile: as SVRaster does.
#pragma once

#include "render/slice_tree.h"
#include "render/trace.h"
#include "tools/bench/pair_sort.h"

namespace neuvv::bench {

struct LeafRasterizer {
    // Room for so many pairs of a tile and a leaf. `shaded`: as the Shader has it. All must outlive it.
    LeafRasterizer(const gpu::Device& device, const render::Field& field, const render::SliceTrees& trees,
                   const gpu::Buffer& shaded, const render::RayBatch& rays, uint32_t pair_capacity);

    const render::Field& field;
    const render::SliceTrees& trees;
    const render::RayBatch& rays;
    uint32_t key_bits;
    SortPairs pairs;
    // Per tile (its first pair, the first after its last) of those that sorted_buffer(key_bits) names; (0, 0) of none.
    gpu::Buffer tile_pairs;
    gpu::Buffer tile_list, tiles_listed;
    PairSorter sorter;
    gpu::ComputePass project, tiles, composite;
    gpu::BindingSet project_set, tiles_set, composite_set;
};

// All rays of an image through one of the slices, shaded from the camera's eye. `camera` is that of the batch's tiles,
// which are those of its image row by row (tiles_of_image).
void record_leaf_raster(gpu::Commands& commands, const LeafRasterizer& rasterizer, uint32_t slice,
                        const ShaderCamera& camera, float stop = render::kStopTransmittance);

// The pairs of the last image. Where they are more than there was room for, it lacks some: make a larger rasterizer.
uint32_t pairs_wanted(const gpu::Device& device, const LeafRasterizer& rasterizer);

}  // namespace neuvv::bench
