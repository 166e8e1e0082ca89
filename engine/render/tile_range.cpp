#include "render/tile_range.h"

#include "spirv/tile_list.comp.h"
#include "spirv/tile_range.comp.h"

namespace neuvv {

namespace {

uint32_t groups_of(uint32_t threads) {
    return (threads + kSliceGroup - 1) / kSliceGroup;
}

// The dispatch over a list rounds its number up to whole rows.
uint64_t list_bytes(uint32_t tiles) {
    return uint64_t{4} * tiles + uint64_t{4} * kListRow;
}

TileRangePush range_push(const Field& field, const ShaderCamera& camera, uint32_t node_base) {
    // A place p is seen by the pixel (x, y) with p − eye = z (corner + x·right + y·down).
    const glm::dmat3 place_from_pixel{glm::dvec3(camera.right), glm::dvec3(camera.down), glm::dvec3(camera.corner)};
    const glm::dmat3 rows = glm::transpose(glm::inverse(place_from_pixel));
    const auto tiles = [](float pixels) { return (static_cast<uint32_t>(pixels) + kTile - 1) / kTile; };
    return {camera.origin,
            glm::vec4(glm::vec3(rows[0]), 0),
            glm::vec4(glm::vec3(rows[1]), 0),
            glm::vec4(glm::vec3(rows[2]), 0),
            glm::vec4(field.box_min, 0),
            glm::vec4(field.box_size, 0),
            field.node_count(),
            tiles(camera.right.w),
            tiles(camera.down.w),
            static_cast<uint32_t>(camera.corner.w),
            node_base};
}

}  // namespace

TileRanges::TileRanges(const Device& device, uint32_t tiles)
    : ranges(device, "tile ranges", uint64_t{8} * tiles, MemoryKind::kDevice, VK_FORMAT_R32G32_UINT),
      list(device, "tile list", list_bytes(tiles), MemoryKind::kDevice, VK_FORMAT_R32_UINT),
      count(device, "count of tiles", sizeof(LiveCount), MemoryKind::kDevice),
      picture_list(device, "picture's tile list", list_bytes(tiles), MemoryKind::kDevice, VK_FORMAT_R32_UINT),
      picture_count(device, "count of the picture's tiles", sizeof(LiveCount), MemoryKind::kDevice) {}

TileRanger::TileRanger(const Device& device, const Field& field, const SliceTrees& trees, const TileRanges& ranges)
    : field_(field),
      trees_(trees),
      ranges_(ranges),
      range_(device, "tile ranges", tile_range_comp),
      list_(device, "tile list", tile_list_comp),
      range_set_(range_, {{kRangeNodes, &trees.nodes},
                          {kRangeInner, &field.inner_cells},
                          {kRangePlaces, &field.node_places},
                          {kRangeTiles, &ranges.ranges}}),
      list_set_(list_, {{kRangeTiles, &ranges.ranges},
                        {kRangeList, &ranges.list},
                        {kRangeCount, &ranges.count},
                        {kRangePictures, &ranges.picture_list},
                        {kRangePictureCount, &ranges.picture_count}}) {}

void record_tile_ranges(Commands& commands, const TileRanger& ranger, uint32_t slice, const ShaderCamera& camera) {
    const PassScope scope(commands, "tile ranges");
    const TileRangePush push = range_push(ranger.field_, camera, ranger.trees_.node_base(slice));
    fill(commands, ranger.ranges_.ranges, 0xffffffff);
    for (const Buffer* list : {&ranger.ranges_.list, &ranger.ranges_.picture_list}) fill(commands, *list, kNoTile);
    for (const Buffer* count : {&ranger.ranges_.count, &ranger.ranges_.picture_count})
        update(commands, *count, LiveCount{0, 1, 1, 0, 0});
    compute_barrier(commands);
    dispatch(commands, ranger.range_, ranger.range_set_, groups_of(push.nodes), push);
    compute_barrier(commands);
    dispatch(commands, ranger.list_, ranger.list_set_, groups_of(push.tiles_across * push.tiles_down), push);
    compute_barrier(commands);
}

}  // namespace neuvv
