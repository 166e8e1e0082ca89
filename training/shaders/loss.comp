// The loss of traced tiles, and its derivative by the colour and alpha of every ray (errata 10, 16).
//   P = srgb(mean over the pixel's rays of C + (1−α) B),  I = srgb(C* + (1−α*) B),  e = |P − I|
//   L = Σ_pixels Σ_channels (P − I)² + λ ((e_right − e)² + (e_below − e)²), where neighbours lie in the same tile
// The losses are sums, not means, as Adam does not depend on their scale; the host divides them by the number of pixels
// for display. One workgroup per tile, one thread per ray; reads 48 bytes and writes 16 bytes per ray.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/training.h"

layout(local_size_x = kTilePixels) in;
layout(binding = kLossRadiance) uniform textureBuffer radiance;
layout(binding = kLossTarget) uniform textureBuffer target;
layout(binding = kLossBackground) uniform textureBuffer background;
layout(binding = kLossAdjoint, rgba32f) writeonly uniform imageBuffer adjoint;
layout(binding = kLossSums, std430) writeonly buffer Sums { vec4 sums[]; };
layout(push_constant) uniform Push { LossPush push; };
#include "srgb.glsl"

shared vec3 composited[kTilePixels];  // per ray: its colour over its background, linear
shared vec4 error[kTilePixels];       // per ray: e of its pixel, and 1 where there is a pixel
shared vec2 losses[kTilePixels];      // per ray: its share in the pixel's (L_rgb, L_grad)

// The difference of e between two pixels, the far one minus the near one; 0 where one of them lies beyond the image.
vec3 difference(uint near, uint far) {
    return (error[far].rgb - error[near].rgb) * (error[near].a * error[far].a);
}

// The mean colour of all rays of the pixel to which the ray at (x, y) in the tile belongs.
vec3 pixel_mean(uint x, uint y) {
    const uint first = y / push.samples * push.samples * kTile + x / push.samples * push.samples;
    vec3 sum = vec3(0.0);
    for (uint j = 0u; j < push.samples; j++)
        for (uint i = 0u; i < push.samples; i++) sum += composited[first + j * kTile + i];
    return sum / float(push.samples * push.samples);
}

void main() {
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    const uint lane = gl_LocalInvocationID.x, x = lane % kTile, y = lane / kTile;
    const int ray = int(group * kTilePixels + lane);
    const vec4 traced = texelFetch(radiance, ray), truth = texelFetch(target, ray);
    const vec3 behind = texelFetch(background, ray).rgb;
    const bool inside = truth.a >= 0.0;
    composited[lane] = traced.rgb + (1.0 - traced.a) * behind;
    barrier();
    const vec3 linear = pixel_mean(x, y);
    const vec3 wrong = inside ? srgb_encode(linear) - srgb_encode(truth.rgb + (1.0 - truth.a) * behind) : vec3(0.0);
    error[lane] = vec4(abs(wrong), inside ? 1.0 : 0.0);
    barrier();

    const vec3 zero = vec3(0.0);
    const uint step = push.samples, row = push.samples * kTile;  // rays to the next pixel, to the right and below
    const vec3 right = x + step < kTile ? difference(lane, lane + step) : zero;
    const vec3 below = y + step < kTile ? difference(lane, lane + row) : zero;
    const vec3 left = x >= step ? difference(lane - step, lane) : zero;
    const vec3 above = y >= step ? difference(lane - row, lane) : zero;
    const vec3 d_error = 2.0 * push.weights.grad * (left + above - right - below);
    const float share = 1.0 / float(push.samples * push.samples);  // of a ray in its pixel
    const vec3 d_colour = share * (2.0 * wrong + sign(wrong) * d_error) * srgb_encode_adjoint(linear);
    imageStore(adjoint, ray, inside ? vec4(d_colour, -dot(d_colour, behind)) : vec4(0.0));

    losses[lane] = share * vec2(dot(wrong, wrong), dot(right, right) + dot(below, below));
    barrier();
    if (lane != 0u) return;
    vec4 sum = vec4(0.0);
    for (uint i = 0u; i < kTilePixels; i++) sum += vec4(losses[i], share * error[i].a, 0.0);
    sums[group] = sum;
}
