// The fine samples of each ray, where the coarse ones found matter: importance sampling as in NeRF, by the blending
// weights that the same network gave the coarse samples. Segments lie between the n + 1 quantiles of that distribution
// (a share kFloor of which is spread evenly), so that they fill the ray's whole way through the box; each has one
// sample at a random position. One workgroup per tile, one thread per ray. Reads 16 bytes per coarse sample and writes
// 16 per fine sample: bound by memory.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/psi.h"

layout(local_size_x = kTilePixels) in;
layout(binding = kPsiCameras) uniform textureBuffer cameras;
layout(binding = kPsiTiles) uniform utextureBuffer tiles;
READ_ARRAY(vec4, kPsiValues, values);
READ_ARRAY(vec4, kPsiRanges, ranges);
WRITE_ARRAY(vec4, kPsiPoints, points);
layout(push_constant) uniform Push { PsiRayPush push; };
#include "trace/composite.glsl"
#include "psi_random.glsl"
#include "rays/every_tile.glsl"
#include "rays/ray.glsl"

const float kFloor = 0.2;  // share of the distribution that is spread evenly

float sigma_of(Ray ray, uint i) {
    return FETCH(values, int((tile_group() * push.coarse + i) * kPsiBlock + ray.in_tile)).x;
}

void main() {
    if (tile_group() >= push.tiles) return;
    const Ray ray = tile_ray();
    const vec2 range = FETCH(ranges, int(ray.index)).xy;
    const float step = (range.y - range.x) / float(push.coarse);
    Composite whole = composite_begin();
    for (uint i = 0u; i < push.coarse; ++i) composite_add(whole, sigma_of(ray, i), step, vec3(0.0), 0.0);
    const float alpha = 1.0 - whole.transmittance;
    // Where the coarse samples found nothing, the whole distribution is even.
    const float found = alpha > 1e-4 ? (1.0 - kFloor) / alpha : 0.0;
    const float even = (1.0 - found * alpha) / float(push.coarse);

    Composite sum = composite_begin();
    uint bin = 0u;
    float below = 0.0, share = even + found * composite_add(sum, sigma_of(ray, 0u), step, vec3(0.0), 0.0);
    float edge = range.x;
    for (uint i = 0u; i < push.fine; ++i) {
        const float goal = float(i + 1u) / float(push.fine);
        while (below + share < goal && bin + 1u < push.coarse) {
            below += share;
            ++bin;
            share = even + found * composite_add(sum, sigma_of(ray, bin), step, vec3(0.0), 0.0);
        }
        const float inside = clamp((goal - below) / share, 0.0, 1.0);
        const float next = i + 1u == push.fine ? range.y : max(range.x + (float(bin) + inside) * step, edge);
        const float t = mix(edge, next, random_at(push.seed, ray.index, push.coarse + i));
        const vec3 at = (ray.origin + t * ray.direction - push.centre.xyz) * push.centre.w;
        STORE(points, int((tile_group() * push.fine + i) * kPsiBlock + ray.in_tile),
              vec4(at, next - edge));
        edge = next;
    }
}
