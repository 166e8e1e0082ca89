// Resolve: turns traced rays into an image of colour over a background (blended in linear light), alpha, or depth. A
// pixel is the mean of its samples × samples rays, each blended with the set: colour and alpha are premultiplied and
// linear, depth is weighted by alpha.
// Reads radiance and depth in tile order; writes straight-alpha sRGB, 8 bits per channel, in rows. One thread per
// pixel, one workgroup per 8×8 pixels. Bound by memory: 20 bytes per ray (40 with a set) and 4 per pixel. The images of
// several views are stored behind each other, and so are their tiles of rays.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/resolve.h"
#include "shared/trace.h"

layout(local_size_x = kTilePixels) in;
layout(constant_id = 0) const bool kListed = false;  // only listed tiles of the images are resolved
layout(constant_id = 1) const bool kSet = false;     // there is a set
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

void main() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x, view;
    uvec2 pixel;
    if (kListed) group = texelFetch(image_tiles, int(group)).x;
    if (group == kNoTile || !pixel_of_thread(group, view, pixel)) return;
    WeightedSum sum = WeightedSum(vec4(0.0), 0.0, 0.0);
    for (uint i = 0u; i < push.samples * push.samples; ++i) {
        const uvec2 texel = push.samples * pixel + uvec2(i % push.samples, i / push.samples);
        const int ray = ray_at(view, texel);
        const WeightedSum one = with_set(view, texel, FETCH(radiance, ray), FETCH(depth, ray).x);
        sum = WeightedSum(sum.light + one.light, sum.metres + one.metres, sum.weight + one.weight);
    }
    const float metres = sum.weight > 0.0 ? sum.metres / sum.weight : uintBitsToFloat(0x7f800000u);
    store_pixel(view, pixel, sum.light / float(push.samples * push.samples), metres);
}
