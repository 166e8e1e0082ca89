// Lists the tiles that see anything (tile_range.comp), so that only those are traced and resolved: tiles of the picture, and
// all tiles of rays in them.
// Reads one word a tile; writes one for each that sees. One thread a tile of the picture; trivial work.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/slice_tree.h"

layout(local_size_x = kSliceGroup) in;
layout(binding = kRangeTiles) uniform utextureBuffer tile_ranges;
layout(binding = kRangeList, r32ui) writeonly uniform uimageBuffer tile_list;
layout(binding = kRangeCount, std430) buffer Count { LiveCount count; };
layout(binding = kRangePictures, r32ui) writeonly uniform uimageBuffer picture_list;
layout(binding = kRangePictureCount, std430) buffer PictureCount { LiveCount picture_count; };
layout(push_constant) uniform Push { TileRangePush push; };

void main() {
    const uint n = push.samples, across = (push.tiles_across + n - 1u) / n, tile = gl_GlobalInvocationID.x;
    const uvec2 first = n * uvec2(tile % across, tile / across);
    const uvec2 end = min(first + n, uvec2(push.tiles_across, push.tiles_down));
    bool sees = false;
    for (uint y = first.y; y < end.y; y++)
        for (uint x = first.x; x < end.x; x++)
            sees = sees || texelFetch(tile_ranges, int(y * push.tiles_across + x)).x != kNoTile;
    if (!sees) return;
    const uint picture_at = atomicAdd(picture_count.slots, 1u);
    imageStore(picture_list, int(picture_at), uvec4(tile));
    atomicMax(picture_count.groups_x, min(picture_at + 1u, kListRow));
    atomicMax(picture_count.groups_y, picture_at / kListRow + 1u);

    const uint tiles = (end.x - first.x) * (end.y - first.y);
    uint at = atomicAdd(count.slots, tiles);
    atomicMax(count.groups_x, min(at + tiles, kListRow));
    atomicMax(count.groups_y, (at + tiles - 1u) / kListRow + 1u);
    for (uint y = first.y; y < end.y; y++)
        for (uint x = first.x; x < end.x; x++) imageStore(tile_list, int(at++), uvec4(y * push.tiles_across + x));
}
