// The ray of one thread: a pixel of its workgroup's tile, in the space of the performer that it is traced through: the
// world, where the performer stands as it was recorded, else the world as an instance's inverse transform shows it (errata
// 13). The includer binds textureBuffer `cameras` and utextureBuffer `tiles`.
#ifndef NEUVV_RAY_GLSL
#define NEUVV_RAY_GLSL
#include "grid.glsl"

// The includer's: which tile this workgroup has, between which distances its rays run (metres), how many cameras
// stand before those in the performer's space, which are the world's (0: they are these), and where along the camera's axis
// something solid ends what is seen at a place of its image (metres).
uint tile_group();
vec2 tile_range(uint tile);
uint first_camera();
float set_end(uint view, vec2 at);

struct Ray {
    uint index;    // of the per-ray buffers
    uint in_tile;  // 0..63, row by row
    uint view;     // the tile's camera
    vec2 at;       // in its image
    vec3 origin;
    vec3 direction;      // unit
    vec2 range;          // metres of it to walk; none (x > y) where the pixel lies beyond the image's edge
    float world_metres;  // of one of its metres
};

const float kFar = 1e30;  // metres

// Moves the n × n rays of a pixel, which are pixels of an enlarged image, within their cells: no two of them share a
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
    const uint camera = tile.x + first_camera();
    const int first = int(kCameraTexels * camera);
    const vec2 size = vec2(texelFetch(cameras, first + 1).w, texelFetch(cameras, first + 2).w);
    const uint samples = uint(texelFetch(cameras, first + 3).w);
    const vec2 place = vec2(cell) + 0.5 + rook_shift(cell, samples) + unpackSnorm2x16(tile.w);
    const vec2 at = vec2(pixel_of_ray(camera_axis(camera, 0u), place.x), pixel_of_ray(camera_axis(camera, 1u), place.y));
    const vec3 line = camera_line(camera, at);
    Ray ray;
    ray.in_tile = inner.y * kTile + inner.x;
    ray.view = tile.x;
    ray.at = at;
    ray.index = group * kTilePixels + ray.in_tile;
    const bool in_image = all(lessThan(vec2(cell), size));
    ray.range = in_image ? tile_range(group) : vec2(kFar, 0.0);
    if (in_image) ray.range.y = min(ray.range.y, set_end(tile.x, at) * length(line));
    ray.origin = texelFetch(cameras, first).xyz;
    ray.direction = normalize(line);
    ray.world_metres = first_camera() == 0u ? 1.0 : length(camera_line(tile.x, at)) / length(line);
    return ray;
}

#endif
