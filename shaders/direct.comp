// The paper's rendering: every number of a leaf evaluated at every sample, no slice. Reference for speed and correctness.
// Reads topology, weights and rows; writes as trace.comp does. One workgroup a tile, one thread a pixel. Bound by memory:
// 16·(2⌈C/4⌉ + N_HH) bytes a sample.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "shared/trace.h"

layout(local_size_x = kTilePixels) in;
layout(constant_id = 0) const uint kHhDegree = 2u;
layout(constant_id = 1) const uint kNodeLevels = 4u;
layout(constant_id = 2) const uint kBasisPlanes = 8u;
layout(constant_id = 3) const uint kBusyPlanes = 8u;
layout(binding = kTraceNodes) uniform utextureBuffer tree_nodes;
layout(binding = kTraceChildren) uniform utextureBuffer tree_children;
layout(binding = kTraceWeights) uniform textureBuffer leaf_weights;
layout(binding = kTraceRows, std140) uniform Rows { BasisRows rows; };
layout(binding = kTraceCameras) uniform textureBuffer cameras;
layout(binding = kTraceTiles) uniform utextureBuffer tiles;
layout(binding = kTraceRadiance, rgba32f) writeonly uniform imageBuffer radiance;
layout(binding = kTraceDepth, r32f) writeonly uniform imageBuffer depth;
layout(push_constant) uniform Push { TracePush push; };
#include "composite.glsl"
#include "march.glsl"
#include "ray.glsl"
#include "sh.glsl"
#include "weights.glsl"

float sh_y[kMaxShCount];
uint here;    // the leaf that the walk stopped at
float sigma;  // its density

// Σ_nm w_nlm H_nlm(d, γ) over one l
vec3 band(uint leaf, uint l, vec4 radial) {
    vec3 raw = vec3(0.0);
    for (uint n = l; n <= kHhDegree; n++)
        for (uint j = l * l; j < (l + 1u) * (l + 1u); j++)
            raw += radial[n] * sh_y[j] * leaf_hh(leaf, kHhBase[n] + j, push.leaf_count);
    return raw;
}

vec3 leaf_colour(uint leaf) {
    const HhRadial radial = hh_radial(leaf_gamma(leaf, push.leaf_count));
    vec3 raw = band(leaf, 0u, radial.l0);
    if (kHhDegree >= 1u) raw += band(leaf, 1u, radial.l1);
    if (kHhDegree >= 2u) raw += band(leaf, 2u, radial.l2);
    if (kHhDegree >= 3u) raw += band(leaf, 3u, radial.l3);
    return 1.0 / (1.0 + exp(-raw));
}

bool march_wants(uint leaf) {
    here = leaf;
    sigma = leaf_sigma(leaf, push.leaf_count);
    return sigma > 0.0;
}

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
        composite_add(sum, sigma, part.t_out - part.t_in, leaf_colour(here), 0.5 * (part.t_in + part.t_out));
    const float alpha = 1.0 - sum.transmittance;
    imageStore(radiance, int(ray.index), vec4(sum.colour, alpha));
    imageStore(depth, int(ray.index), vec4(alpha > 0.0 ? sum.depth / alpha : uintBitsToFloat(0x7f800000u)));
}
