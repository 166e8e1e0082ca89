// Finds where each tile's pairs begin and end among the sorted pairs, and lists the tiles that have pairs.
// Reads keys; writes where the tile changes from one pair to the next. One workgroup per block of the sort, dispatched
// indirectly. Bound by memory: 8 bytes per pair.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/leaf_raster.h"

layout(local_size_x = kSortGroup) in;
layout(constant_id = 0) const uint kNodeLevels = 4u;
layout(binding = kLeafTilesKeys) uniform utextureBuffer keys;
layout(binding = kLeafTilesCount, std430) readonly buffer Pairs { LiveCount pair_count; };
layout(binding = kLeafTilesOut, std430) writeonly buffer TilePairs { uint tile_pairs[]; };
layout(binding = kLeafTilesList, r32ui) writeonly uniform uimageBuffer list;
layout(binding = kLeafTilesListed, std430) buffer Listed { LiveCount count; };
layout(push_constant) uniform Push { LeafTilesPush push; };
#include "rays/append_tile.glsl"
#include "leaf_key.glsl"

uint tile_at(uint pair) { return pair_tile(texelFetch(keys, int(pair)).xy); }

void begin_tile(uint tile, uint pair) {
    tile_pairs[2u * tile] = pair;
    append_tile(tile);
}

void main() {
    const uint pairs = min(pair_count.slots, push.capacity), end = min((gl_WorkGroupID.x + 1u) * kSortBlock, pairs);
    for (uint at = gl_WorkGroupID.x * kSortBlock + gl_LocalInvocationID.x; at < end; at += kSortGroup) {
        const uint tile = tile_at(at);
        if (at == 0u || tile_at(at - 1u) != tile) begin_tile(tile, at);
        if (at + 1u == pairs || tile_at(at + 1u) != tile) tile_pairs[2u * tile + 1u] = at + 1u;
    }
}
