// Lists the tiles where an instance may be seen (tile_range.comp), so that only those are traced; and those of the pictures
// where any instance of this frame may be seen, so that only those are resolved.
// Reads two words a tile; writes one for each that sees. One thread a tile of the pictures; trivial work.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/slice_tree.h"

layout(local_size_x = kSliceGroup) in;
layout(binding = kRangeTiles) uniform utextureBuffer tile_ranges;
layout(binding = kRangeList, r32ui) writeonly uniform uimageBuffer tile_list;
layout(binding = kRangeCount, std430) buffer Count { LiveCount count; };
layout(binding = kRangeSeen, std430) buffer Seen { uint seen[]; };
layout(binding = kRangePictures, r32ui) writeonly uniform uimageBuffer picture_list;
layout(binding = kRangePictureCount, std430) buffer PictureCount { LiveCount picture_count; };
layout(push_constant) uniform Push { TileRangePush push; };

void list_ray_tile(uint tile) {
    const uint at = atomicAdd(count.slots, 1u);
    imageStore(tile_list, int(at), uvec4(tile));
    atomicMax(count.groups_x, min(at + 1u, kListRow));
    atomicMax(count.groups_y, at / kListRow + 1u);
}

void list_picture_tile(uint tile) {
    const uint at = atomicAdd(picture_count.slots, 1u);
    imageStore(picture_list, int(at), uvec4(tile));
    atomicMax(picture_count.groups_x, min(at + 1u, kListRow));
    atomicMax(picture_count.groups_y, at / kListRow + 1u);
}

void main() {
    const uint n = push.samples, across = (push.tiles_across + n - 1u) / n, down = (push.tiles_down + n - 1u) / n;
    const uint tile = gl_GlobalInvocationID.x, view = tile / (across * down), at = tile % (across * down);
    if (view >= push.views) return;
    const uvec2 first = n * uvec2(at % across, at / across);
    const uvec2 end = min(first + n, uvec2(push.tiles_across, push.tiles_down));
    bool sees = false;
    for (uint y = first.y; y < end.y; y++)
        for (uint x = first.x; x < end.x; x++) {
            const uint ray_tile = (view * push.tiles_down + y) * push.tiles_across + x;
            if (texelFetch(tile_ranges, int(ray_tile)).x == kNoTile) continue;
            sees = true;
            list_ray_tile(ray_tile);
        }
    if (!sees || seen[tile] != 0u) return;
    seen[tile] = 1u;
    list_picture_tile(tile);
}
