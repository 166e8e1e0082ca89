// Resolve: traced rays to a picture. Colour over a background (blended in linear light), alpha, or depth.
// A pixel is the mean of its samples × samples rays, colour and alpha premultiplied and linear, depth by alpha.
// Reads radiance and depth in tile order; writes straight-alpha sRGB, 8 bits a channel, in rows. One thread a pixel, one
// workgroup 8×8 pixels. Bound by memory: 20 bytes a ray and 4 a pixel. Pictures of several views stand behind each other,
// each with all its tiles of rays.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/resolve.h"
#include "shared/trace.h"
#include "srgb.glsl"

layout(local_size_x = kTilePixels) in;
layout(constant_id = 0) const bool kListed = false;  // only some of the picture's tiles
layout(binding = kResolveRadiance) uniform textureBuffer radiance;
layout(binding = kResolveDepth) uniform textureBuffer depth;
layout(binding = kResolvePicture, r32ui) writeonly uniform uimageBuffer picture;
layout(binding = kResolveTiles) uniform utextureBuffer picture_tiles;
layout(push_constant) uniform Push { ResolvePush push; };

vec4 show_colour(vec4 light) {
    const vec4 sum = light + (1.0 - light.a) * vec4(push.background.rgb, 1.0) * push.background.a;
    return sum.a > 0.0 ? vec4(srgb_encode(sum.rgb / sum.a), sum.a) : vec4(0.0);
}

vec4 show_depth(float metres) {
    const float grey = 1.0 - (metres - push.depth_near) / (push.depth_far - push.depth_near);
    return vec4(vec3(isinf(metres) ? 0.0 : clamp(grey, 0.0, 1.0)), 1.0);
}

// Where a ray of the picture stands in the buffers.
int ray_at(uvec2 at, uint tiles_across) {
    const uvec2 tile = at / kTile, inner = at % kTile;
    return int((tile.y * tiles_across + tile.x) * kTilePixels + inner.y * kTile + inner.x);
}

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    if (kListed) group = texelFetch(picture_tiles, int(group)).x;
    if (group == kNoTile) return;
    const uint across = (push.width + kTile - 1u) / kTile, down = (push.height + kTile - 1u) / kTile;
    const uint lane = gl_LocalInvocationID.x, view = group / (across * down), tile = group % (across * down);
    const uint x = tile % across * kTile + lane % kTile, y = tile / across * kTile + lane / kTile;
    if (x >= push.width || y >= push.height) return;
    const uint rays_across = (push.samples * push.width + kTile - 1u) / kTile;
    const uint first_ray = view * rays_across * ((push.samples * push.height + kTile - 1u) / kTile) * kTilePixels;
    vec4 light = vec4(0.0);
    float metres = 0.0;
    for (uint i = 0u; i < push.samples * push.samples; i++) {
        const int ray =
            int(first_ray) + ray_at(push.samples * uvec2(x, y) + uvec2(i % push.samples, i / push.samples), rays_across);
        const vec4 one = texelFetch(radiance, ray);
        light += one;
        if (one.a > 0.0) metres += one.a * texelFetch(depth, ray).x;
    }
    metres = light.a > 0.0 ? metres / light.a : uintBitsToFloat(0x7f800000u);
    light /= float(push.samples * push.samples);
    vec4 shown = show_colour(light);
    if (push.show == kShowAlpha) shown = vec4(light.aaa, 1.0);
    if (push.show == kShowDepth) shown = show_depth(metres);
    imageStore(picture, int((view * push.height + y) * push.width + x), uvec4(packUnorm4x8(shown)));
}
