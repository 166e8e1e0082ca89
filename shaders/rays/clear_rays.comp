// Clear rays: makes the rays of listed tiles transparent, at infinite depth.
// Writes 20 bytes per ray. One workgroup per listed tile, one thread per ray, dispatched indirectly. Bound by memory.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/clear_rays.h"

layout(local_size_x = kTilePixels) in;
layout(binding = kClearList) uniform utextureBuffer list;
WRITE_ARRAY(vec4, kClearRadiance, radiance);
WRITE_ARRAY(float, kClearDepth, depth);

void main() {
    const uint tile = texelFetch(list, int(gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x)).x;
    if (tile == kNoTile) return;
    const int ray = int(tile * kTilePixels + gl_LocalInvocationID.x);
    STORE(radiance, ray, vec4(0.0));
    STORE(depth, ray, vec4(uintBitsToFloat(0x7f800000u)));
}
