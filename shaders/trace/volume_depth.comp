// Volume depth: the rays' expected depth of termination (errata 12), in metres along the camera's axis, at each texel
// of the set's image; infinity where alpha is 0.
// Reads radiance and depth in tile order; writes rows. One thread per texel of all views. Bound by memory: 24 bytes per
// texel.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/trace.h"
#include "shared/volume_depth.h"

layout(local_size_x = kTilePixels) in;
READ_ARRAY(vec4, kVolumeRadiance, radiance);
READ_ARRAY(float, kVolumeDepth, depth);
layout(binding = kVolumeCameras) uniform textureBuffer cameras;
WRITE_ARRAY(float, kVolumeOut, volume_depth);
layout(push_constant) uniform Push { VolumeDepthPush push; };
#include "rays/grid.glsl"

void main() {
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    const uint thread = group * kTilePixels + gl_LocalInvocationID.x, texels = push.width * push.height;
    const uint view = thread / texels;
    if (view >= push.views) return;
    const vec2 at = vec2(thread % texels % push.width, thread % texels / push.width) + 0.5;
    const vec2 rays = vec2(ray_of_pixel(camera_axis(view, 0u), at.x), ray_of_pixel(camera_axis(view, 1u), at.y));
    const uvec2 cell = uvec2(min(rays, vec2(push.tiles_across, push.tiles_down) * float(kTile) - 1.0));
    const uvec2 tile = cell / kTile, inner = cell % kTile;
    const uint first = ((view * push.tiles_down + tile.y) * push.tiles_across + tile.x) * kTilePixels;
    const int ray = int(first + inner.y * kTile + inner.x);
    float metres = uintBitsToFloat(0x7f800000u);
    if (FETCH(radiance, ray).a > 0.0) metres = FETCH(depth, ray).x / length(camera_line(view, at));
    STORE(volume_depth, int(thread), vec4(metres));
}
