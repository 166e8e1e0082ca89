// Upscale: turns rays into an image where there are fewer rays than pixels (grid.glsl). The filter is Catmull-Rom over
// 4×4 rays, rows first; each result is clamped to the range of its two nearest inputs, so that edges get no halo. Where
// a ray is at a pixel's centre, the pixel is that ray.
// Reads radiance and depth in tile order; writes as resolve.comp does. One thread per pixel, one workgroup per 8×8
// pixels, of the listed tiles, or of all where there is a set. Bound by its 20 fetches per pixel, most of them from
// cache.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/resolve.h"
#include "shared/trace.h"

layout(local_size_x = kTilePixels) in;
layout(constant_id = 0) const bool kListed = true;
layout(constant_id = 1) const bool kSet = false;
READ_ARRAY(vec4, kResolveRadiance, radiance);
READ_ARRAY(float, kResolveDepth, depth);
WRITE_ARRAY(uint, kResolveImage, image);
layout(binding = kResolveTiles) uniform utextureBuffer image_tiles;
layout(binding = kResolveCameras) uniform textureBuffer cameras;
READ_ARRAY(half4, kResolveSetColour, set_colour);
READ_ARRAY(half4, kResolveSetFront, set_front);
READ_ARRAY(float, kResolveSetDepth, set_depth);
layout(push_constant) uniform Push { ResolvePush push; };
#include "rays/show.glsl"

// The weights of the rays at −1, 0, 1 and 2 for a position between those at 0 and 1.
vec4 catmull_rom(float at) {
    const float a = at, a2 = a * a, a3 = a2 * a;
    return 0.5 * vec4(2.0 * a2 - a - a3, 2.0 - 5.0 * a2 + 3.0 * a3, a + 4.0 * a2 - 3.0 * a3, a3 - a2);
}

struct Filtered {
    vec4 light;  // premultiplied, linear
    float metres;
};

// The weighted sum, clamped to the range of b and c.
vec4 between(vec4 weights, vec4 a, vec4 b, vec4 c, vec4 d) {
    return clamp(weights.x * a + weights.y * b + weights.z * c + weights.w * d, min(b, c), max(b, c));
}

// The filtered rays at a position in the view's grid of rays, whose last ray is `last`. Depth is filtered bilinearly.
Filtered filtered_at(uint view, vec2 position, ivec2 last) {
    const ivec2 first = ivec2(floor(position - 0.5));
    const vec2 part = position - 0.5 - vec2(first);
    const vec4 across = catmull_rom(part.x);
    vec4 rows[4];
    float metres = 0.0, weight = 0.0;
    for (int y = 0; y < 4; ++y) {
        vec4 row[4];
        for (int x = 0; x < 4; ++x) {
            const int ray = ray_at(view, uvec2(clamp(first + ivec2(x, y) - 1, ivec2(0), last)));
            row[x] = FETCH(radiance, ray);
            if (x == 0 || x == 3 || y == 0 || y == 3) continue;
            const float share = row[x].a * (x == 1 ? 1.0 - part.x : part.x) * (y == 1 ? 1.0 - part.y : part.y);
            if (share > 0.0) metres += share * FETCH(depth, ray).x;
            weight += share;
        }
        rows[y] = between(across, row[0], row[1], row[2], row[3]);
    }
    return Filtered(between(catmull_rom(part.y), rows[0], rows[1], rows[2], rows[3]),
                    weight > 0.0 ? metres / weight : uintBitsToFloat(0x7f800000u));
}

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, view;
    if (kListed) group = texelFetch(image_tiles, int(group)).x;
    uvec2 pixel;
    if (group == kNoTile || !pixel_of_thread(group, view, pixel)) return;
    const int camera = int(kCameraTexels * view);
    const ivec2 last = ivec2(texelFetch(cameras, camera + 1).w, texelFetch(cameras, camera + 2).w) - 1;
    const vec2 position = vec2(ray_of_pixel(camera_axis(view, 0u), float(pixel.x) + 0.5),
                               ray_of_pixel(camera_axis(view, 1u), float(pixel.y) + 0.5));
    const Filtered ray = filtered_at(view, position, last);
    const WeightedSum sum = with_set(view, pixel, ray.light, ray.metres);
    store_pixel(view, pixel, sum.light, sum.weight > 0.0 ? sum.metres / sum.weight : uintBitsToFloat(0x7f800000u));
}
