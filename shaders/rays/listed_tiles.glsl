// For ray.glsl, where only the tiles that an instance may cover have a workgroup (tile_range.comp), and rays end at the
// end of their tile's range or at the set. Where kRayOutput is kOutputRay, the functions are those of every_tile.glsl.
// The includer binds utextureBuffers `tile_list` and `tile_ranges` and declares the array `set_depth`.
#ifndef NEUVV_LISTED_TILES_GLSL
#define NEUVV_LISTED_TILES_GLSL
#include "arrays.glsl"

// Beyond the list's end this is kNoTile, and such a tile has no rays.
uint tile_group() {
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    return kRayOutput != kOutputRay ? texelFetch(tile_list, int(group)).x : group;
}

vec2 tile_range(uint tile) {
    if (kRayOutput == kOutputRay) return vec2(0.0, 1e30);
    if (tile < push.first_tile || tile >= push.end_tile) return vec2(1.0, 0.0);
    const uvec2 bits = texelFetch(tile_ranges, int(tile)).xy;
    return bits.x == kNoTile ? vec2(1.0, 0.0) : uintBitsToFloat(uvec2(bits.x, ~bits.y));
}

uint first_camera() { return kRayOutput != kOutputRay ? push.first_camera : 0u; }

// The distance of the set, metres along the camera's axis, at a position of a view's image.
float set_end(uint view, vec2 at) {
    if (kRayOutput == kOutputRay || push.set_width == 0u) return 1e30;
    const uvec2 texel = uvec2(at);
    return FETCH(set_depth, int(view * push.set_texels + texel.y * push.set_width + texel.x)).x;
}

#endif
