// The loss of traced tiles and its derivative by every ray's colour and alpha (errata 10, 16).
//   P = srgb(C + (1−α) B),  I = srgb(C* + (1−α*) B),  e = |P − I|
//   L = Σ_pixels Σ_channels (P − I)² + λ ((e_right − e)² + (e_below − e)²), neighbours inside the tile only
// Sums, not means: Adam does not see the scale, and the host divides by the pixels for display. One workgroup a tile;
// reads 48 bytes a ray, writes 16.
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

shared vec4 error[kTilePixels];  // e, and 1 where there is a pixel
shared vec2 losses[kTilePixels];

// The forward difference of e between two pixels; 0 where either lies beyond the picture.
vec3 difference(uint near, uint far) {
    return (error[far].rgb - error[near].rgb) * (error[near].a * error[far].a);
}

void main() {
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    const uint lane = gl_LocalInvocationID.x, x = lane % kTile, y = lane / kTile;
    const int ray = int(group * kTilePixels + lane);
    const vec4 traced = texelFetch(radiance, ray), truth = texelFetch(target, ray);
    const vec3 behind = texelFetch(background, ray).rgb;
    const bool inside = truth.a >= 0.0;
    const vec3 linear = traced.rgb + (1.0 - traced.a) * behind;
    const vec3 wrong = inside ? srgb_encode(linear) - srgb_encode(truth.rgb + (1.0 - truth.a) * behind) : vec3(0.0);
    error[lane] = vec4(abs(wrong), inside ? 1.0 : 0.0);
    barrier();

    const vec3 zero = vec3(0.0);
    const vec3 right = x + 1u < kTile ? difference(lane, lane + 1u) : zero;
    const vec3 below = y + 1u < kTile ? difference(lane, lane + kTile) : zero;
    const vec3 left = x > 0u ? difference(lane - 1u, lane) : zero;
    const vec3 above = y > 0u ? difference(lane - kTile, lane) : zero;
    const vec3 d_error = 2.0 * push.lambda_grad * (left + above - right - below);
    const vec3 d_colour = (2.0 * wrong + sign(wrong) * d_error) * srgb_encode_adjoint(linear);
    imageStore(adjoint, ray, inside ? vec4(d_colour, -dot(d_colour, behind)) : vec4(0.0));

    losses[lane] = vec2(dot(wrong, wrong), dot(right, right) + dot(below, below));
    barrier();
    if (lane != 0u) return;
    vec4 sum = vec4(0.0);
    for (uint i = 0u; i < kTilePixels; i++) sum += vec4(losses[i], error[i].a, 0.0);
    sums[group] = sum;
}
