// Upscale: rays that are fewer than pixels (grid.glsl) to an image. Catmull-Rom over 4×4 rays, rows first, each result held
// between its two nearest, so that no edge gets a halo; where a ray stands at each pixel's centre it is that ray.
// Reads radiance and depth in tile order; writes as resolve.comp does. One thread a pixel, one workgroup 8×8 pixels,
// of the listed tiles or with a set of all. Bound by its 20 fetches a pixel, most of them from cache.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/resolve.h"
#include "shared/trace.h"

layout(local_size_x = kTilePixels) in;
layout(constant_id = 0) const bool kListed = true;
layout(constant_id = 1) const bool kSet = false;
layout(binding = kResolveRadiance) uniform textureBuffer radiance;
layout(binding = kResolveDepth) uniform textureBuffer depth;
layout(binding = kResolveImage, r32ui) writeonly uniform uimageBuffer image;
layout(binding = kResolveTiles) uniform utextureBuffer image_tiles;
layout(binding = kResolveCameras) uniform textureBuffer cameras;
layout(binding = kResolveSetColour) uniform textureBuffer set_colour;
layout(binding = kResolveSetFront) uniform textureBuffer set_front;
layout(binding = kResolveSetDepth) uniform textureBuffer set_depth;
layout(push_constant) uniform Push { ResolvePush push; };
#include "show.glsl"

// Of the rays at −1, 0, 1 and 2 for a place between those at 0 and 1.
vec4 catmull_rom(float at) {
    const float a = at, a2 = a * a, a3 = a2 * a;
    return 0.5 * vec4(2.0 * a2 - a - a3, 2.0 - 5.0 * a2 + 3.0 * a3, a + 4.0 * a2 - 3.0 * a3, a3 - a2);
}

struct Seen {
    vec4 light;  // premultiplied, linear
    float metres;
};

// Between b and c, weighted; held between these.
vec4 between(vec4 weights, vec4 a, vec4 b, vec4 c, vec4 d) {
    return clamp(weights.x * a + weights.y * b + weights.z * c + weights.w * d, min(b, c), max(b, c));
}

Seen light_between(uint view, vec2 place, ivec2 last) {
    const ivec2 first = ivec2(floor(place - 0.5));
    const vec2 part = place - 0.5 - vec2(first);
    const vec4 across = catmull_rom(part.x);
    vec4 rows[4];
    float metres = 0.0, weight = 0.0;
    for (int y = 0; y < 4; y++) {
        vec4 row[4];
        for (int x = 0; x < 4; x++) {
            const int ray = ray_at(view, uvec2(clamp(first + ivec2(x, y) - 1, ivec2(0), last)));
            row[x] = texelFetch(radiance, ray);
            if (x == 0 || x == 3 || y == 0 || y == 3) continue;
            const float near = row[x].a * (x == 1 ? 1.0 - part.x : part.x) * (y == 1 ? 1.0 - part.y : part.y);
            if (near > 0.0) metres += near * texelFetch(depth, ray).x;
            weight += near;
        }
        rows[y] = between(across, row[0], row[1], row[2], row[3]);
    }
    return Seen(between(catmull_rom(part.y), rows[0], rows[1], rows[2], rows[3]),
                weight > 0.0 ? metres / weight : uintBitsToFloat(0x7f800000u));
}

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, view;
    if (kListed) group = texelFetch(image_tiles, int(group)).x;
    uvec2 pixel;
    if (group == kNoTile || !pixel_of_thread(group, view, pixel)) return;
    const int camera = int(kCameraTexels * view);
    const ivec2 last = ivec2(texelFetch(cameras, camera + 1).w, texelFetch(cameras, camera + 2).w) - 1;
    const vec2 place = vec2(ray_of_pixel(camera_axis(view, 0u), float(pixel.x) + 0.5),
                            ray_of_pixel(camera_axis(view, 1u), float(pixel.y) + 0.5));
    const Seen seen = light_between(view, place, last);
    const Shown shown = with_set(view, pixel, seen.light, seen.metres);
    store_pixel(view, pixel, shown.light,
                shown.weight > 0.0 ? shown.metres / shown.weight : uintBitsToFloat(0x7f800000u));
}
