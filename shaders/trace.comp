// Trace: the rays of 8×8 pixel tiles through a slice.
// Reads topology, head (σ, slot) and SH of live leaves; writes premultiplied linear RGB and alpha, and depth in metres, a ray.
// One workgroup a tile, one thread a pixel. Bound by dependent fetches of the walk, then by (n_max+1)² texels of SH a sample.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/trace.h"

layout(local_size_x = kTilePixels) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
layout(constant_id = 1) const uint kNodeLevels = 4u;
layout(binding = kTraceNodes) uniform utextureBuffer tree_nodes;
layout(binding = kTraceChildren) uniform utextureBuffer tree_children;
layout(binding = kTraceHead) uniform utextureBuffer head;
layout(binding = kTraceSh) uniform textureBuffer slice_sh;
layout(binding = kTraceCameras) uniform textureBuffer cameras;
layout(binding = kTraceTiles) uniform utextureBuffer tiles;
layout(binding = kTraceRadiance, rgba32f) writeonly uniform imageBuffer radiance;
layout(binding = kTraceDepth, r32f) writeonly uniform imageBuffer depth;
layout(push_constant) uniform Push { TracePush push; };
#include "composite.glsl"
#include "march.glsl"
#include "ray.glsl"
#include "slice_sample.glsl"

void main() {
    if (tile_group() * kTilePixels >= uint(imageSize(radiance))) return;
    const Ray ray = tile_ray();
    sh_y = sh_basis(ray.direction_world);
    Composite sum = composite_begin();
    March march = march_begin((ray.origin_world - push.box_min.xyz) / push.box_size.xyz,
                              ray.direction_world / push.box_size.xyz);
    march.inside = march.inside && ray.inside;
    MarchSegment part;
    while (sum.transmittance >= push.box_min.w && march_next(march, part))
        composite_add(sum, sigma, part.t_out - part.t_in, slice_colour(), 0.5 * (part.t_in + part.t_out));
    const float alpha = 1.0 - sum.transmittance;
    imageStore(radiance, int(ray.index), vec4(sum.colour, alpha));
    imageStore(depth, int(ray.index), vec4(alpha > 0.0 ? sum.depth / alpha : uintBitsToFloat(0x7f800000u)));
}
