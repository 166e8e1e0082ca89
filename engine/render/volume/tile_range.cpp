#include "render/volume/tile_range.h"

#include <algorithm>

#include "spirv/tile_list.comp.h"
#include "spirv/tile_range.comp.h"

namespace neuvv::render {

uint32_t range_level(const Field& field, glm::vec3 eye, double focal_pixels) {
    const glm::vec3 outside = glm::max(glm::max(field.leaves_min - eye, eye - field.leaves_max), 0.0f);
    const double largest_m = 0.5 * kTile * glm::length(outside) / focal_pixels;
    const auto levels = static_cast<uint32_t>(field.level_begin.size()) - 1;
    double edge_m = std::max({field.box_size.x, field.box_size.y, field.box_size.z});
    uint32_t level = 0;
    for (; level + 1 < levels && edge_m > largest_m; ++level) edge_m /= 4;
    return level;
}

TileRanger::TileRanger(const gpu::Device& device, const Field& given_field, const SliceTrees* given_trees,
                       const TileRanges& given_ranges)
    : field(given_field),
      trees(given_trees),
      ranges(given_ranges),
      range(device, "tile ranges", device.buffers().fitting(tile_range_comp, tile_range_comp_storage)),
      list(device, "tile list", tile_list_comp),
      range_set(range, {{kRangeNodes, trees ? &trees->nodes : &field.nodes},
                        {kRangeCells, &field.node_cells},
                        {kRangePositions, &field.node_positions},
                        {kRangeViews, &ranges.views},
                        {kRangeTiles, &ranges.ranges}}),
      list_set(list, {{kRangeTiles, &ranges.ranges},
                      {kRangeList, &ranges.list},
                      {kRangeCount, &ranges.count},
                      {kRangeCovered, &ranges.covered},
                      {kRangeSharing, &ranges.sharing}}) {}

void record_tile_ranges(gpu::Commands& commands, const TileRanger& ranger, uint32_t slice, uint32_t first_view,
                        uint32_t level, const ViewLayout& layout, bool counted) {
    const gpu::PassScope scope(commands, "tile ranges");
    const Field& field = ranger.field;
    const TileRangePush push{glm::vec4(field.box_min, 0),
                             glm::vec4(field.box_size, 0),
                             field.level_begin[level + 1],
                             level + 2 < field.level_begin.size() ? field.level_begin[level] : field.node_count(),
                             ranger.trees ? ranger.trees->node_base(slice) : 0,
                             first_view,
                             layout.views,
                             layout.tiles_across(),
                             layout.tiles_down(),
                             counted ? 1u : 0u};
    gpu::fill(commands, ranger.ranges.ranges, 0xffffffff, uint64_t{8} * layout.ray_tiles());
    record_empty_list(commands, ranger.ranges.list, ranger.ranges.count, layout.ray_tiles());
    gpu::dispatch(commands, ranger.range, ranger.range_set, push.nodes, push);
    gpu::compute_barrier(commands);
    gpu::dispatch(commands, ranger.list, ranger.list_set, layout.ray_tiles(), push);
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::render
