// The rays of 8×8 pixel tiles, front to back; main() of trace.comp, trace_tree.comp and direct.comp, which differ in what a
// ray samples (slice_sample.glsl, tree_sample.glsl, direct_sample.glsl), and say by kDear whether that is dearer than a
// descent (march.glsl). One workgroup a tile, one thread a pixel. Writes premultiplied linear RGB and alpha, and depth in
// metres, a ray.
#include "composite.glsl"
#include "ray.glsl"

void main() {
    if (tile_group() * kTilePixels >= uint(imageSize(radiance))) return;
    const Ray ray = tile_ray();
    sh_y = sh_basis(ray.direction_world);
    Composite sum = composite_begin();
    March march = march_begin((ray.origin_world - push.box_min.xyz) / push.box_size.xyz,
                              ray.direction_world / push.box_size.xyz, ray.range);
    MarchSegment part;
    while (sum.transmittance >= push.box_min.w && march_enter(march))
        while (sum.transmittance >= push.box_min.w && (kDear ? march_next(march, part) : march_leaf(march, part)))
            composite_add(sum, sigma, part.t_out - part.t_in, sample_colour(), 0.5 * (part.t_in + part.t_out));
    const float alpha = 1.0 - sum.transmittance;
    imageStore(radiance, int(ray.index), vec4(sum.colour, alpha));
    imageStore(depth, int(ray.index), vec4(alpha > 0.0 ? sum.depth / alpha : uintBitsToFloat(0x7f800000u)));
}
