// The loss of traced tiles, and its derivative by the colour and alpha of every ray (errata 10, 16).
//   P = srgb(mean over the pixel's rays of C + (1−α) B),  I = srgb(C* + (1−α*) B),  e = |P − I|
//   L = Σ_pixels Σ_channels (P − I)² + λ ((e_right − e)² + (e_below − e)²), where neighbours lie in the same tile
// Where cameras have colours of their own, C is what the tile's camera makes of the traced colour. The targets are then
// as the mean camera would see them, for the point loss, and the tile's camera makes C* of them.
// Where what a camera sees is below 0, the slope of srgb is taken as that at 0, so that a brighter target pulls it
// back. The losses are sums, not means, as Adam does not depend on their scale; the host divides them by the number of
// pixels for display. One workgroup per tile, one thread per ray; reads 48 bytes and writes 16 bytes per ray.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/training.h"

layout(local_size_x = kTilePixels) in;
READ_ARRAY(vec4, kLossRadiance, radiance);
READ_ARRAY(vec4, kLossTarget, target);
READ_ARRAY(vec4, kLossBackground, background);
WRITE_ARRAY(vec4, kLossAdjoint, adjoint);
layout(binding = kLossSums, std430) writeonly buffer Sums { vec4 sums[]; };
layout(binding = kLossColours, std430) readonly buffer Colours { CameraColour colours[]; };
layout(binding = kLossColourGradients, std430) writeonly buffer Gradients { CameraColour colour_gradients[]; };
layout(push_constant) uniform Push { LossPush push; };
#include "srgb.glsl"

shared vec3 composited[kTilePixels];  // per ray: its colour over its background, linear
shared vec4 error[kTilePixels];       // per ray: e of its pixel, and 1 where there is a pixel
shared vec2 losses[kTilePixels];      // per ray: its share in the pixel's (L_rgb, L_grad)
shared vec4 foreground[kTilePixels];  // per ray: its traced (C, α)
shared vec3 d_seen[kTilePixels];      // per ray: ∂L/∂C as the tile's camera sees it

// The colour of a foreground (C, α) as the tile's camera sees it.
vec3 seen(uint tile, vec4 c) {
    if (push.colours == 0u) return c.rgb;
    return vec3(dot(colours[tile].rows[0], c), dot(colours[tile].rows[1], c), dot(colours[tile].rows[2], c));
}

// The derivative by the foreground (C, α), from the derivative by the colour that the tile's camera sees.
vec4 seen_adjoint(uint tile, vec3 d) {
    if (push.colours == 0u) return vec4(d, 0.0);
    return d.r * colours[tile].rows[0] + d.g * colours[tile].rows[1] + d.b * colours[tile].rows[2];
}

// The derivative by a row of the camera's colour, summed over the tile.
vec4 row_gradient(uint row) {
    vec4 sum = vec4(0.0);
    for (uint i = 0u; i < kTilePixels; ++i) sum += d_seen[i][row] * foreground[i];
    return sum;
}

// The difference of e between two pixels, the far one minus the near one; 0 where one of them lies beyond the image.
vec3 difference(uint near, uint far) {
    return (error[far].rgb - error[near].rgb) * (error[near].a * error[far].a);
}

// The mean colour of all rays of the pixel to which the ray at (x, y) in the tile belongs.
vec3 pixel_mean(uint x, uint y) {
    const uint first = y / push.samples * push.samples * kTile + x / push.samples * push.samples;
    vec3 sum = vec3(0.0);
    for (uint j = 0u; j < push.samples; ++j)
        for (uint i = 0u; i < push.samples; ++i) sum += composited[first + j * kTile + i];
    return sum / float(push.samples * push.samples);
}

void main() {
    const uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    const uint lane = gl_LocalInvocationID.x, x = lane % kTile, y = lane / kTile;
    const int ray = int(group * kTilePixels + lane);
    const vec4 traced = FETCH(radiance, ray), truth = FETCH(target, ray);
    const vec3 behind = FETCH(background, ray).rgb;
    const bool inside = truth.a >= 0.0;
    foreground[lane] = traced;
    composited[lane] = seen(group, traced) + (1.0 - traced.a) * behind;
    barrier();
    const vec3 linear = pixel_mean(x, y);
    const vec3 shown = seen(group, truth) + (1.0 - truth.a) * behind;
    const vec3 wrong = inside ? srgb_encode(linear) - srgb_encode(shown) : vec3(0.0);
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
    const vec4 d_ray = seen_adjoint(group, d_colour) - vec4(vec3(0.0), dot(d_colour, behind));
    STORE(adjoint, ray, inside ? d_ray : vec4(0.0));
    d_seen[lane] = inside ? d_colour : vec3(0.0);

    losses[lane] = share * vec2(dot(wrong, wrong), dot(right, right) + dot(below, below));
    barrier();
    if (push.colours != 0u && lane < 3u) colour_gradients[group].rows[lane] = row_gradient(lane);
    if (lane != 0u) return;
    vec4 sum = vec4(0.0);
    for (uint i = 0u; i < kTilePixels; ++i) sum += vec4(losses[i], share * error[i].a, 0.0);
    sums[group] = sum;
}
