// Inspect: turns statistics of rays' walks (shared/inspect.h) into an image that shows levels or steps by a colour map,
// and black where these are 0. A pixel shows the level of the one of its samples × samples rays that met a leaf
// nearest, or the mean of their steps. Where there are fewer rays than pixels, it shows the nearest ray.
// Reads radiance and depth in tile order; writes as resolve.comp does, opaque. One thread per pixel, one workgroup per
// 8×8 pixels. Bound by memory: 20 bytes per ray and 4 per pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/inspect.h"
#include "shared/trace.h"

layout(local_size_x = kTilePixels) in;
READ_ARRAY(vec4, kInspectRays, rays);
READ_ARRAY(float, kInspectDepth, depth);
layout(binding = kInspectCameras) uniform textureBuffer cameras;
WRITE_ARRAY(uint, kInspectImage, image);
layout(push_constant) uniform Push { InspectPush push; };
#include "rays/colour_map.glsl"
#include "rays/grid.glsl"
#include "rays/image_pixel.glsl"

// The ray whose cell of the grid contains a position of the image.
uvec2 nearest_ray(uint view, vec2 position) {
    const int camera = int(kCameraTexels * view);
    const vec2 last = vec2(texelFetch(cameras, camera + 1).w, texelFetch(cameras, camera + 2).w) - 1.0;
    const vec2 at = vec2(ray_of_pixel(camera_axis(view, 0u), position.x),
                         ray_of_pixel(camera_axis(view, 1u), position.y));
    return uvec2(clamp(floor(at), vec2(0.0), last));
}

void main() {
    uint view;
    uvec2 pixel;
    if (!pixel_of_thread(gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, view, pixel)) return;
    float level = 0.0, nearest = uintBitsToFloat(0x7f800000u), steps = 0.0;
    for (uint i = 0u; i < push.samples * push.samples; ++i) {
        const uvec2 texel = push.samples * pixel + uvec2(i % push.samples, i / push.samples);
        const int ray = ray_at(view, nearest_ray(view, vec2(texel) + 0.5));
        const vec4 statistics = FETCH(rays, ray);
        const float metres = FETCH(depth, ray).x;
        if (metres < nearest) level = statistics.x;
        nearest = min(nearest, metres);
        steps += statistics.y;
    }
    const float value = push.level != 0u ? level : steps / float(push.samples * push.samples);
    const float share = clamp((value - push.colour_map_min) / (push.colour_map_max - push.colour_map_min), 0.0, 1.0);
    const vec4 colour = vec4(value > 0.0 ? viridis(share) : vec3(0.0), 1.0);
    STORE(image, int((view * push.height + pixel.y) * push.width + pixel.x), uvec4(packUnorm4x8(colour)));
}
