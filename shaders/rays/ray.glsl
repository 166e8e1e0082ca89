// The ray of one thread, through a pixel of its workgroup's tile, in the space of the performer that it is traced
// through. That is the world where a field is traced as recorded, and the world under the inverse transform of the
// instance otherwise (errata 13). The includer binds textureBuffer `cameras` and utextureBuffer `tiles`.
#ifndef NEUVV_RAY_GLSL
#define NEUVV_RAY_GLSL
#include "rays/grid.glsl"

// Functions that the includer defines.
uint tile_group();                  // the index of this workgroup's tile
vec2 tile_range(uint tile);         // the distances between which the tile's rays run, metres
uint first_camera();                // of the first camera in the performer's space; 0: the world is that space
float set_end(uint view, vec2 at);  // metres along the camera's axis at which the set ends the ray through `at`

struct Ray {
    uint index;    // in the per-ray buffers
    uint in_tile;  // 0..63, row by row
    uint view;     // the tile's camera
    vec2 at;       // its position in the camera's image, pixels
    vec3 origin;
    vec3 direction;      // unit
    vec2 range;          // metres along the ray to walk; x > y where the pixel lies beyond the image's edge
    float world_metres;  // metres in the world of one metre along the ray
};

const float kFar = 1e30;  // metres

// Shifts the n × n rays of a pixel, which are pixels of an enlarged image, within their cells, so that no two of them
// share a column or a row. Then a nearly vertical or horizontal edge has n² shades in place of n.
vec2 rook_shift(uvec2 cell, uint n) {
    const uvec2 of_pixel = cell % n;
    return (vec2(of_pixel.y, n - 1u - of_pixel.x) + 0.5) / float(n) - 0.5;
}

// Eight consecutive threads have 4×2 pixels, 32 have 8×4, so that rays that run together take similar paths.
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
    const vec2 shifted = vec2(cell) + 0.5 + rook_shift(cell, samples) + unpackSnorm2x16(tile.w);
    const vec2 at = vec2(pixel_of_ray(camera_axis(camera, 0u), shifted.x),
                         pixel_of_ray(camera_axis(camera, 1u), shifted.y));
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
