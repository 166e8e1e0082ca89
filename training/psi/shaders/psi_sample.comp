// The coarse samples of each ray, stratified as in NeRF: the part of the ray inside the box is cut into equal segments,
// each of which has one sample at a random position. Rays that miss the box get segments of length 0. One workgroup per
// tile, one thread per ray. Writes 16 bytes per sample: bound by memory.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "arrays.glsl"
#include "shared/psi.h"

layout(local_size_x = kTilePixels) in;
layout(binding = kPsiCameras) uniform textureBuffer cameras;
layout(binding = kPsiTiles) uniform utextureBuffer tiles;
WRITE_ARRAY(vec4, kPsiPoints, points);
WRITE_ARRAY(vec4, kPsiDirections, directions);
WRITE_ARRAY(vec4, kPsiRanges, ranges);
layout(push_constant) uniform Push { PsiRayPush push; };
#include "psi_random.glsl"
#include "rays/every_tile.glsl"
#include "rays/ray.glsl"

// The distances at which the ray enters and leaves the box; 0 and 0 where it misses the box.
vec2 box_range(Ray ray) {
    const vec3 safe = mix(ray.direction, vec3(1e-20), lessThan(abs(ray.direction), vec3(1e-20)));
    const vec3 a = (push.box_min.xyz - ray.origin) / safe;
    const vec3 b = (push.box_min.xyz + push.box_size.xyz - ray.origin) / safe;
    const vec3 near = min(a, b), far = max(a, b);
    const vec2 range = vec2(max(max(near.x, near.y), max(near.z, 0.0)), min(far.x, min(far.y, far.z)));
    return range.x < range.y && ray.range.x < ray.range.y ? range : vec2(0.0);
}

void main() {
    if (tile_group() >= push.tiles) return;
    const Ray ray = tile_ray();
    const vec2 range = box_range(ray);
    STORE(directions, int(ray.index), vec4(ray.direction, 0.0));
    STORE(ranges, int(ray.index), vec4(range, 0.0, 0.0));
    const float step = (range.y - range.x) / float(push.coarse);
    for (uint i = 0u; i < push.coarse; ++i) {
        const float t = range.x + (float(i) + random_at(push.seed, ray.index, i)) * step;
        const vec3 at = (ray.origin + t * ray.direction - push.centre.xyz) * push.centre.w;
        STORE(points, int((tile_group() * push.coarse + i) * kPsiBlock + ray.in_tile), vec4(at, step));
    }
}
