// Tile list: lists the tiles that an instance may cover (tile_range.comp), so that only these are traced, and marks
// them as covered.
// Reads one word per tile; writes two words, or three where instances are counted, per covered tile. One thread per
// tile of all views; trivial work.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/slice_tree.h"

layout(local_size_x = kSliceGroup) in;
layout(binding = kRangeTiles) uniform utextureBuffer tile_ranges;
layout(binding = kRangeList, r32ui) writeonly uniform uimageBuffer list;
layout(binding = kRangeCount, std430) buffer Count { LiveCount count; };
layout(binding = kRangeCovered, r32ui) writeonly uniform uimageBuffer covered;
layout(binding = kRangeSharing, r32ui) uniform uimageBuffer sharing;
layout(push_constant) uniform Push { TileRangePush push; };
#include "rays/append_tile.glsl"

void main() {
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    const uint tile = group * kSliceGroup + gl_LocalInvocationID.x;
    if (tile >= push.views * push.tiles_across * push.tiles_down) return;
    if (texelFetch(tile_ranges, int(tile)).x == kNoTile) return;
    imageStore(covered, int(tile), uvec4(1u));
    if (push.counted != 0u) imageStore(sharing, int(tile), imageLoad(sharing, int(tile)) + 1u);
    append_tile(tile);
}
