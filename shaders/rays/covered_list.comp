// Covered list: lists the tiles that instances of the last frame may have covered, so that only their rays are cleared,
// and marks them as not covered.
// Reads one word per tile; writes two words per covered tile. One thread per tile; trivial work.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/clear_rays.h"

layout(local_size_x = kSliceGroup) in;
layout(binding = kClearCovered, r32ui) uniform uimageBuffer covered;
layout(binding = kClearList, r32ui) writeonly uniform uimageBuffer list;
layout(binding = kClearCount, std430) buffer Count { LiveCount count; };
layout(push_constant) uniform Push { CoveredListPush push; };
#include "rays/append_tile.glsl"

void main() {
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    const uint tile = group * kSliceGroup + gl_LocalInvocationID.x;
    if (tile >= push.tiles || imageLoad(covered, int(tile)).x == 0u) return;
    imageStore(covered, int(tile), uvec4(0u));
    append_tile(tile);
}
