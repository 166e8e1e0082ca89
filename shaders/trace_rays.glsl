// The rays of 8×8 pixel tiles, front to back; main() of trace.comp, trace_tree.comp and direct.comp, which differ in what a
// ray samples (slice_sample.glsl, tree_sample.glsl, direct_sample.glsl), and say by kDear whether that is dearer than a
// descent (march.glsl). One workgroup a tile, one thread a pixel. Writes premultiplied linear RGB and alpha, and depth in
// world metres, a ray; where kLayered is set, of this instance and of what stands there, which earlier ones left.
#include "composite.glsl"
#include "ray.glsl"

// All of the ray's range lies behind something solid. What is left out is less than early termination leaves out.
bool is_hidden(Ray ray) {
    return kLayered && imageLoad(depth, int(ray.index)).x < ray.range.x * ray.world_metres &&
           imageLoad(radiance, int(ray.index)).a > 1.0 - push.box_min.w;
}

// The paper's Algorithm 1 (errata 11): the nearer layer over the farther one.
void store_ray(Ray ray, vec4 light, float world_metres) {
    if (kLayered) {
        const vec4 there = imageLoad(radiance, int(ray.index));
        const float there_metres = imageLoad(depth, int(ray.index)).x;
        const bool nearer = world_metres <= there_metres;
        light = nearer ? light + (1.0 - light.a) * there : there + (1.0 - there.a) * light;
        world_metres = min(world_metres, there_metres);
    }
    imageStore(radiance, int(ray.index), light);
    imageStore(depth, int(ray.index), vec4(world_metres));
}

void main() {
    if (tile_group() * kTilePixels >= uint(imageSize(radiance))) return;
    const Ray ray = tile_ray();
    sample_begin(ray.direction, ray.view);
    Composite sum = composite_begin();
    March march = march_begin((ray.origin - push.box_min.xyz) / push.box_size.xyz, ray.direction / push.box_size.xyz,
                              is_hidden(ray) ? vec2(kFar, 0.0) : ray.range);
    MarchSegment part;
    while (sum.transmittance >= push.box_min.w && march_enter(march))
        while (sum.transmittance >= push.box_min.w && (kDear ? march_next(march, part) : march_leaf(march, part)))
            composite_add(sum, sigma, part.t_out - part.t_in, sample_colour(), 0.5 * (part.t_in + part.t_out));
    const float alpha = 1.0 - sum.transmittance;
    const float metres = alpha > 0.0 ? sum.depth / alpha : uintBitsToFloat(0x7f800000u);
    store_ray(ray, vec4(sum.colour, alpha), metres * ray.world_metres);
}
