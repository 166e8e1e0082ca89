#include "tools/bench/leaf_raster.h"

#include "gpu/host_copies.h"
#include "render/volume/tile_range.h"

#include <bit>

#include "render/volume/trace_tree.h"
#include "shared/leaf_raster.h"
#include "spirv/leaf_composite.comp.h"
#include "spirv/leaf_pairs.comp.h"
#include "spirv/leaf_tiles.comp.h"

namespace neuvv::bench {

namespace {

uint32_t bits_of_key(const render::Field& field, const render::RayBatch& rays) {
    return 6 * field.node_levels + static_cast<uint32_t>(std::bit_width(rays.tile_capacity - 1));
}

LeafRasterPush raster_push(const render::Field& field, const render::SliceTrees& trees, uint32_t slice,
                           const ShaderCamera& camera, uint32_t capacity, float stop) {
    const RangeView view = render::range_view(camera);
    return {glm::vec4(glm::vec3(camera.origin), camera.corner.w),
            view.row_x,
            view.row_y,
            view.row_z,
            glm::vec4(field.box_min, stop),
            glm::vec4(field.box_size, 0),
            static_cast<uint32_t>(camera.right.w),
            static_cast<uint32_t>(camera.down.w),
            slice,
            trees.capacity,
            capacity};
}

}  // namespace

LeafRasterizer::LeafRasterizer(const gpu::Device& device, const render::Field& given_field,
                               const render::SliceTrees& given_trees, const gpu::Buffer& shaded,
                               const render::RayBatch& given_rays, uint32_t pair_capacity)
    : field(given_field),
      trees(given_trees),
      rays(given_rays),
      key_bits(bits_of_key(field, rays)),
      pairs(device, pair_capacity),
      tile_pairs(device, "pairs of tiles", uint64_t{8} * rays.tile_capacity, gpu::MemoryKind::kDevice,
                 VK_FORMAT_R32G32_UINT),
      tile_list(device, "tiles with pairs", uint64_t{4} * (rays.tile_capacity + kListRow), gpu::MemoryKind::kDevice,
                VK_FORMAT_R32_UINT),
      tiles_listed(device, "count of tiles with pairs", sizeof(LiveCount), gpu::MemoryKind::kDevice),
      sorter(device, pairs),
      project(device, "leaf pairs", leaf_pairs_comp, {field.node_levels}),
      tiles(device, "leaf tiles", leaf_tiles_comp, {field.node_levels}),
      composite(device, "leaf composite", leaf_composite_comp, {field.node_levels}),
      project_set(project, {{kPairsLeaves, &trees.entry_leaf},
                            {kPairsPositions, &field.leaf_positions},
                            {kPairsEntries, &trees.counts},
                            {kPairsKeys, &pairs.keys[0]},
                            {kPairsValues, &pairs.values[0]},
                            {kPairsCount, &pairs.count}}),
      tiles_set(tiles, {{kLeafTilesKeys, &pairs.keys[sorted_buffer(key_bits)]},
                        {kLeafTilesCount, &pairs.count},
                        {kLeafTilesOut, &tile_pairs},
                        {kLeafTilesList, &tile_list},
                        {kLeafTilesListed, &tiles_listed}}),
      composite_set(composite, {{kCompositePairs, &tile_pairs},
                                {kCompositeValues, &pairs.values[sorted_buffer(key_bits)]},
                                {kCompositeEntries, &shaded},
                                {kCompositeLeaves, &trees.entry_leaf},
                                {kCompositePositions, &field.leaf_positions},
                                {kTraceCameras, &rays.cameras},
                                {kTraceTiles, &rays.tiles},
                                {kTraceTileList, &tile_list},
                                {kTraceRadiance, &rays.radiance},
                                {kTraceDepth, &rays.depth}}) {}

void record_leaf_raster(gpu::Commands& commands, const LeafRasterizer& r, uint32_t slice, const ShaderCamera& camera,
                        float stop) {
    const LeafRasterPush push = raster_push(r.field, r.trees, slice, camera, r.pairs.capacity, stop);
    {
        const gpu::PassScope scope(commands, "project");
        gpu::update(commands, r.pairs.count, LiveCount{0, 1, 1, 0, 0});
        gpu::compute_barrier(commands);
        gpu::dispatch_indirect(commands, r.project, r.project_set, r.trees.counts, slice * sizeof(LiveCount), push);
        gpu::compute_barrier(commands);
    }
    {
        const gpu::PassScope scope(commands, "sort");
        record_pair_sort(commands, r.sorter, r.key_bits);
    }
    const gpu::PassScope scope(commands, "composite");
    render::record_clear(commands, r.rays, r.rays.tile_capacity);
    gpu::fill(commands, r.tile_pairs, 0);
    gpu::fill(commands, r.tile_list, kNoTile);
    gpu::update(commands, r.tiles_listed, LiveCount{0, 1, 1, 0, 0});
    gpu::compute_barrier(commands);
    gpu::dispatch_indirect(commands, r.tiles, r.tiles_set, r.pairs.count, 0, LeafTilesPush{r.pairs.capacity});
    gpu::compute_barrier(commands);
    gpu::dispatch_indirect(commands, r.composite, r.composite_set, r.tiles_listed, 0, push);
    gpu::compute_barrier(commands);
}

uint32_t pair_count(const gpu::Device& device, const LeafRasterizer& rasterizer) {
    LiveCount count{};
    gpu::download(device, rasterizer.pairs.count, &count, sizeof(count));
    return count.slots;
}

}  // namespace neuvv::bench
