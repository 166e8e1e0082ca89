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
#include "sh.glsl"

float sh_y[kMaxShCount];
Composite sum;

vec3 slice_colour(uint slot) {
    vec3 raw = vec3(0.0);
    const int first = int(slot * sh_count(kHhDegree));
    for (uint j = 0u; j < sh_count(kHhDegree); j++) raw += sh_y[j] * texelFetch(slice_sh, first + int(j)).rgb;
    return 1.0 / (1.0 + exp(-raw));  // errata 8
}

bool march_visit(uint leaf, float t_in, float t_out) {
    const uvec2 entry = texelFetch(head, int(leaf)).xy;
    const float sigma = uintBitsToFloat(entry.x);
    if (sigma > 0.0)
        composite_add(sum, sigma, t_out - t_in, slice_colour(entry.y), 0.5 * (t_in + t_out));
    return sum.transmittance >= push.box_min.w;
}

void main() {
    if (tile_group() * kTilePixels >= uint(imageSize(radiance))) return;
    const Ray ray = tile_ray();
    sum = composite_begin();
    sh_y = sh_basis(ray.direction_world);
    if (ray.inside) march((ray.origin_world - push.box_min.xyz) / push.box_size.xyz, ray.direction_world / push.box_size.xyz);
    const float alpha = 1.0 - sum.transmittance;
    imageStore(radiance, int(ray.index), vec4(sum.colour, alpha));
    imageStore(depth, int(ray.index), vec4(alpha > 0.0 ? sum.depth / alpha : uintBitsToFloat(0x7f800000u)));
}
