// Projects live leaves: writes a pair for each leaf and each tile of 8×8 pixels whose rays may meet it.
// Reads the leaves of entries and their positions; writes keys and values of pairs, in no order. One thread per entry,
// dispatched indirectly. Bound by arithmetic, some 150 operations per leaf; where the eye is close, by the leaves that
// cover most tiles.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/leaf_raster.h"

layout(local_size_x = kSliceGroup) in;
layout(constant_id = 0) const uint kNodeLevels = 4u;
layout(binding = kPairsLeaves) uniform utextureBuffer entry_leaf;
layout(binding = kPairsPositions) uniform utextureBuffer leaf_positions;
layout(binding = kPairsEntries, std430) readonly buffer Entries { LiveCount entry_counts[]; };
layout(binding = kPairsKeys, rg32ui) writeonly uniform uimageBuffer keys;
layout(binding = kPairsValues, r32ui) writeonly uniform uimageBuffer values;
layout(binding = kPairsCount, std430) buffer Count { LiveCount count; };
layout(push_constant) uniform Push { LeafRasterPush push; };
#include "leaf_pixels.glsl"

shared uint group_count;
shared uint group_first;

// Reserves consecutive pairs for this thread, and returns the index of the first. All threads of the group must call
// it.
uint reserve_pairs(uint number) {
    if (gl_LocalInvocationID.x == 0u) group_count = 0u;
    barrier();
    const uint offset = number > 0u ? atomicAdd(group_count, number) : 0u;
    barrier();
    if (gl_LocalInvocationID.x == 0u && group_count > 0u) {
        group_first = atomicAdd(count.slots, group_count);
        const uint end = min(group_first + group_count, push.capacity);
        atomicMax(count.groups_x, (end + kSortBlock - 1u) / kSortBlock);
    }
    barrier();
    return group_first + offset;
}

void main() {
    const uint entry = gl_GlobalInvocationID.x;
    const bool in_slice = entry < min(entry_counts[push.slice].slots, push.entry_capacity);
    uint leaf_index = kNoLeaf;
    if (in_slice) leaf_index = texelFetch(entry_leaf, int(push.slice * push.entry_capacity + entry)).x;
    const LeafCell leaf = leaf_cell(texelFetch(leaf_positions, int(leaf_index == kNoLeaf ? 0u : leaf_index)).xy);
    const Pixels pixels = leaf_pixels(leaf);
    const uvec2 tile = pixels.first / kTile;
    const uvec2 tiles = (pixels.end + kTile - 1u) / kTile - tile;
    const uint number = leaf_index != kNoLeaf && pixels.first.x < pixels.end.x ? tiles.x * tiles.y : 0u;
    const uint first = reserve_pairs(number);

    const float side = float(1u << kFinestDepth);
    const vec3 eye = (push.eye.xyz - push.box_min.xyz) / push.box_size.xyz * side;
    const uvec2 near = nearness(leaf, uvec3(clamp(floor(eye), 0.0, side - 1.0)));
    const uint across = (push.width + kTile - 1u) / kTile;
    for (uint i = 0u; i < number && first + i < push.capacity; ++i) {
        const uvec2 at = tile + uvec2(i % tiles.x, i / tiles.x);
        imageStore(keys, int(first + i), uvec4(pair_key(at.y * across + at.x, near), 0u, 0u));
        imageStore(values, int(first + i), uvec4(entry));
    }
}
