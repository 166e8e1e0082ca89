#include "render/leaf_raster.h"

#include "render/tile_range.h"

#include <bit>

#include "render/trace_tree.h"
#include "shared/leaf_raster.h"
#include "spirv/leaf_composite.comp.h"
#include "spirv/leaf_pairs.comp.h"
#include "spirv/leaf_tiles.comp.h"

namespace neuvv::render {

namespace {

uint32_t bits_of_key(const Field& field, const RayBatch& rays) {
    return 6 * field.node_levels + static_cast<uint32_t>(std::bit_width(rays.tile_capacity - 1));
}

LeafRasterPush raster_push(const Field& field, const SliceTrees& trees, uint32_t slice, const ShaderCamera& camera,
                           uint32_t capacity, float stop) {
    const RangeView view = range_view(camera);
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

LeafRasterizer::LeafRasterizer(const gpu::Device& device, const Field& field, const SliceTrees& trees,
                               const gpu::Buffer& shaded, const RayBatch& rays, uint32_t pair_capacity)
    : field_(field),
      trees_(trees),
      rays_(rays),
      key_bits_(bits_of_key(field, rays)),
      pairs_(device, pair_capacity),
      tile_pairs_(device, "pairs of tiles", uint64_t{8} * rays.tile_capacity, gpu::MemoryKind::kDevice,
                  VK_FORMAT_R32G32_UINT),
      tile_list_(device, "tiles with pairs", uint64_t{4} * (rays.tile_capacity + kListRow), gpu::MemoryKind::kDevice,
                 VK_FORMAT_R32_UINT),
      tiles_listed_(device, "count of tiles with pairs", sizeof(LiveCount), gpu::MemoryKind::kDevice),
      sorter_(device, pairs_),
      project_(device, "leaf pairs", leaf_pairs_comp, {field.node_levels}),
      tiles_(device, "leaf tiles", leaf_tiles_comp, {field.node_levels}),
      composite_(device, "leaf composite", leaf_composite_comp, {field.node_levels}),
      project_set_(project_, {{kPairsLeaves, &trees.entry_leaf},
                              {kPairsPlaces, &field.leaf_places},
                              {kPairsEntries, &trees.counts},
                              {kPairsKeys, &pairs_.keys[0]},
                              {kPairsValues, &pairs_.values[0]},
                              {kPairsCount, &pairs_.count}}),
      tiles_set_(tiles_, {{kLeafTilesKeys, &pairs_.keys[sorted_buffer(key_bits_)]},
                          {kLeafTilesCount, &pairs_.count},
                          {kLeafTilesOut, &tile_pairs_},
                          {kLeafTilesList, &tile_list_},
                          {kLeafTilesListed, &tiles_listed_}}),
      composite_set_(composite_, {{kCompositePairs, &tile_pairs_},
                                  {kCompositeValues, &pairs_.values[sorted_buffer(key_bits_)]},
                                  {kCompositeEntries, &shaded},
                                  {kCompositeLeaves, &trees.entry_leaf},
                                  {kCompositePlaces, &field.leaf_places},
                                  {kTraceCameras, &rays.cameras},
                                  {kTraceTiles, &rays.tiles},
                                  {kTraceTileList, &tile_list_},
                                  {kTraceRadiance, &rays.radiance},
                                  {kTraceDepth, &rays.depth}}) {}

void record_leaf_raster(gpu::Commands& commands, const LeafRasterizer& r, uint32_t slice, const ShaderCamera& camera,
                        float stop) {
    const LeafRasterPush push = raster_push(r.field_, r.trees_, slice, camera, r.pairs_.capacity, stop);
    {
        const gpu::PassScope scope(commands, "project");
        gpu::update(commands, r.pairs_.count, LiveCount{0, 1, 1, 0, 0});
        gpu::compute_barrier(commands);
        gpu::dispatch_indirect(commands, r.project_, r.project_set_, r.trees_.counts, slice * sizeof(LiveCount), push);
        gpu::compute_barrier(commands);
    }
    {
        const gpu::PassScope scope(commands, "sort");
        record_pair_sort(commands, r.sorter_, r.key_bits_);
    }
    const gpu::PassScope scope(commands, "composite");
    record_clear(commands, r.rays_, r.rays_.tile_capacity);
    gpu::fill(commands, r.tile_pairs_, 0);
    gpu::fill(commands, r.tile_list_, kNoTile);
    gpu::update(commands, r.tiles_listed_, LiveCount{0, 1, 1, 0, 0});
    gpu::compute_barrier(commands);
    gpu::dispatch_indirect(commands, r.tiles_, r.tiles_set_, r.pairs_.count, 0, LeafTilesPush{r.pairs_.capacity});
    gpu::compute_barrier(commands);
    gpu::dispatch_indirect(commands, r.composite_, r.composite_set_, r.tiles_listed_, 0, push);
    gpu::compute_barrier(commands);
}

uint32_t pairs_wanted(const gpu::Device& device, const LeafRasterizer& rasterizer) {
    LiveCount count;
    gpu::download(device, rasterizer.pairs().count, &count, sizeof(count));
    return count.slots;
}

}  // namespace neuvv::render
