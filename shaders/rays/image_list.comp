// Image list: lists the tiles of the images that use rays of a tile that an instance may cover, and those that did so
// in the last frame, so that only these are resolved. Reads a word for each tile of rays that a tile of an image uses;
// reads and writes a word per tile of an image, and writes one per listed tile. One thread per tile of all images;
// trivial work.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/image_list.h"

layout(local_size_x = kSliceGroup) in;
layout(binding = kListCovered) uniform utextureBuffer covered;
layout(binding = kListCameras) uniform textureBuffer cameras;
layout(binding = kListImages, r32ui) writeonly uniform uimageBuffer list;
layout(binding = kListShown, r32ui) uniform uimageBuffer shown;
layout(binding = kListCount, std430) buffer Count { LiveCount count; };
layout(push_constant) uniform Push { ImageListPush push; };
#include "rays/append_tile.glsl"
#include "rays/grid.glsl"

// The first and the last tile of rays along an axis that pixels of the image's tile `at` use.
uvec2 ray_tiles(uint view, uint axis, uint at, uint tiles) {
    const GridAxis grid = camera_axis(view, axis);
    const float pixel = float(push.samples * kTile * at), end = pixel + float(push.samples * kTile);
    const float first = floor(ray_of_pixel(grid, pixel)) - push.radius;
    const float last = ceil(ray_of_pixel(grid, end)) - 1.0 + push.radius;
    const ivec2 rays = ivec2(first, last);
    return uvec2(clamp(rays / int(kTile), ivec2(0), ivec2(tiles - 1u)));
}

void main() {
    const uint a_view = push.images_across * push.images_down;
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    const uint tile = group * kSliceGroup + gl_LocalInvocationID.x, view = tile / a_view, at = tile % a_view;
    if (view >= push.views) return;
    const uvec2 x = ray_tiles(view, 0u, at % push.images_across, push.tiles_across);
    const uvec2 y = ray_tiles(view, 1u, at / push.images_across, push.tiles_down);
    bool any = false;
    for (uint row = y.x; row <= y.y; ++row)
        for (uint column = x.x; column <= x.y; ++column)
            any = any || texelFetch(covered, int((view * push.tiles_down + row) * push.tiles_across + column)).x != 0u;
    const bool shown_before = imageLoad(shown, int(tile)).x != 0u;
    if (any != shown_before) imageStore(shown, int(tile), uvec4(any ? 1u : 0u));
    if (any || shown_before) append_tile(tile);
}
