// The ray of one thread: a pixel of its workgroup's tile. The includer binds textureBuffer `cameras` and utextureBuffer
// `tiles`, and says which tile this is (tile_group) and how far its rays may go (tile_range, metres).
#ifndef NEUVV_RAY_GLSL
#define NEUVV_RAY_GLSL

struct Ray {
    uint index;    // of the per-ray buffers
    uint in_tile;  // 0..63, row by row
    vec3 origin_world;
    vec3 direction_world;  // unit
    vec2 range;  // metres of it to walk; none (x > y) where the pixel lies beyond the picture's edge
};

const float kFar = 1e30;  // metres

// Moves the n × n rays of a pixel, which are pixels of an enlarged picture, within their cells: no two of them share a
// column or a row then, and an edge near the upright or the level shows n² shades in place of n.
vec2 rook_shift(uvec2 cell, uint n) {
    const uvec2 of_pixel = cell % n;
    return (vec2(of_pixel.y, n - 1u - of_pixel.x) + 0.5) / float(n) - 0.5;
}

// Eight neighbours in number are 4×2 pixels, 32 are 8×4: rays that run together look alike.
uvec2 tile_pixel(uint thread) {
    return uvec2((thread & 3u) | (thread & 8u) >> 1u, (thread & 4u) >> 2u | (thread & 48u) >> 3u);
}

Ray tile_ray() {
    const uint group = tile_group();
    const uvec4 tile = texelFetch(tiles, int(group));
    const uvec2 inner = tile_pixel(gl_LocalInvocationID.x);
    const uvec2 cell = tile.yz + inner;
    const vec2 pixel = vec2(cell);
    const int camera = int(4u * tile.x);
    const vec4 right = texelFetch(cameras, camera + 1), down = texelFetch(cameras, camera + 2);
    const vec4 corner = texelFetch(cameras, camera + 3);
    const vec2 at = pixel + 0.5 + rook_shift(cell, uint(corner.w)) + unpackSnorm2x16(tile.w);
    Ray ray;
    ray.in_tile = inner.y * kTile + inner.x;
    ray.index = group * kTilePixels + ray.in_tile;
    ray.range = pixel.x < right.w && pixel.y < down.w ? tile_range(group) : vec2(kFar, 0.0);
    ray.origin_world = texelFetch(cameras, camera).xyz;
    ray.direction_world = normalize(corner.xyz + at.x * right.xyz + at.y * down.xyz);
    return ray;
}

#endif
