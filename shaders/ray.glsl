// The ray of one thread: a pixel of its workgroup's tile. The includer binds textureBuffer `cameras` and utextureBuffer
// `tiles`.
#ifndef NEUVV_RAY_GLSL
#define NEUVV_RAY_GLSL

struct Ray {
    uint index;  // of the per-ray buffers
    bool inside; // false: the pixel lies beyond the picture's edge
    vec3 origin_world;
    vec3 direction_world;  // unit
};

// The workgroup's tile. A dispatch of very many tiles rounds their number up: check it against the buffers' end.
uint tile_group() { return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x; }

// Moves the n × n rays of a pixel, which are pixels of an enlarged picture, within their cells: no two of them share a
// column or a row then, and an edge near the upright or the level shows n² shades in place of n.
vec2 rook_shift(uvec2 cell, uint n) {
    const uvec2 of_pixel = cell % n;
    return (vec2(of_pixel.y, n - 1u - of_pixel.x) + 0.5) / float(n) - 0.5;
}

Ray tile_ray() {
    const uint group = tile_group();
    const uvec4 tile = texelFetch(tiles, int(group));
    const uint lane = gl_LocalInvocationID.x;
    const uvec2 cell = uvec2(tile.y + lane % kTile, tile.z + lane / kTile);
    const vec2 pixel = vec2(cell);
    const int camera = int(4u * tile.x);
    const vec4 right = texelFetch(cameras, camera + 1), down = texelFetch(cameras, camera + 2);
    const vec4 corner = texelFetch(cameras, camera + 3);
    const vec2 at = pixel + 0.5 + rook_shift(cell, uint(corner.w)) + unpackSnorm2x16(tile.w);
    Ray ray;
    ray.index = group * kTilePixels + lane;
    ray.inside = pixel.x < right.w && pixel.y < down.w;
    ray.origin_world = texelFetch(cameras, camera).xyz;
    ray.direction_world = normalize(corner.xyz + at.x * right.xyz + at.y * down.xyz);
    return ray;
}

#endif
