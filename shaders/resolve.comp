// Resolve: traced rays to a picture. Colour over a background (blended in linear light), alpha, or depth.
// Reads radiance and depth in tile order; writes straight-alpha sRGB, 8 bits a channel, in rows. One thread a pixel, one
// workgroup a tile. Bound by memory: 24 bytes a pixel.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/resolve.h"
#include "shared/trace.h"
#include "srgb.glsl"

layout(local_size_x = kTilePixels) in;
layout(binding = kResolveRadiance) uniform textureBuffer radiance;
layout(binding = kResolveDepth) uniform textureBuffer depth;
layout(binding = kResolvePicture, r32ui) writeonly uniform uimageBuffer picture;
layout(push_constant) uniform Push { ResolvePush push; };

vec4 show_colour(vec4 light) {
    const vec4 sum = light + (1.0 - light.a) * vec4(push.background.rgb, 1.0) * push.background.a;
    return sum.a > 0.0 ? vec4(srgb_encode(sum.rgb / sum.a), sum.a) : vec4(0.0);
}

vec4 show_depth(float metres) {
    const float grey = 1.0 - (metres - push.depth_near) / (push.depth_far - push.depth_near);
    return vec4(vec3(isinf(metres) ? 0.0 : clamp(grey, 0.0, 1.0)), 1.0);
}

void main() {
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    const uint across = (push.width + kTile - 1u) / kTile;
    const uint lane = gl_LocalInvocationID.x;
    const uint x = group % across * kTile + lane % kTile, y = group / across * kTile + lane / kTile;
    if (x >= push.width || y >= push.height) return;
    const int ray = int(group * kTilePixels + lane);
    const vec4 light = texelFetch(radiance, ray);
    vec4 shown = show_colour(light);
    if (push.show == kShowAlpha) shown = vec4(light.aaa, 1.0);
    if (push.show == kShowDepth) shown = show_depth(texelFetch(depth, ray).x);
    imageStore(picture, int(y * push.width + x), uvec4(packUnorm4x8(shown)));
}
