// Only the tiles where an instance may be seen have a workgroup (tile_range.comp), and its rays end where their tile's range
// does. Where kLayered is not set, as every_tile.glsl. The includer binds utextureBuffers `tile_list` and `tile_ranges`.
#ifndef NEUVV_LISTED_TILES_GLSL
#define NEUVV_LISTED_TILES_GLSL

// kNoTile beyond the list: such a tile has no rays.
uint tile_group() {
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    return kLayered ? texelFetch(tile_list, int(group)).x : group;
}

vec2 tile_range(uint tile) {
    if (!kLayered) return vec2(0.0, 1e30);
    const uvec2 bits = texelFetch(tile_ranges, int(tile)).xy;
    return bits.x == kNoTile ? vec2(1.0, 0.0) : uintBitsToFloat(uvec2(bits.x, ~bits.y));
}

uint first_camera() { return kLayered ? push.first_camera : 0u; }

#endif
