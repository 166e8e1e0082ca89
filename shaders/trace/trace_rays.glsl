// Traces the rays of a tile of 8×8 pixels, front to back: main() of trace.comp, trace_tree.comp and direct.comp. These
// differ in what a ray samples (slice_sample.glsl, tree_sample.glsl, direct_sample.glsl), and say by kSampleCost what a
// sample costs (shared/trace.h). One workgroup per tile, one thread per ray. The ray's premultiplied linear RGB, alpha
// and depth are stored by store_ray.glsl or store_instance.glsl, which the includer includes after composite.glsl and
// ray.glsl. It says by kSrgbColours whether colours are sRGB: these are summed as such along a ray, as PlenOctrees are
// trained, and the sum is decoded. Intervals, which are merged with those of other instances, are decoded one by one.
#include "arrays.glsl"
#include "srgb.glsl"

// Goes on within the node, or with kSampleAboveDescent within the tree. Returns false where nothing is left there.
// `found`: whether it came to a leaf to sample.
bool march_on(inout March march, out MarchInterval part, out bool found) {
    if (kSampleCost == kSampleLikeStep) {
        const bool in_node = march.in_node;
        found = in_node && march_cell(march, part);
        return in_node;
    }
    found = kSampleCost == kSampleBelowDescent ? march_leaf(march, part) : march_next(march, part);
    return found;
}

void main() {
    if (tile_group() * kTilePixels >= uint(ELEMENTS(radiance))) return;
    const Ray ray = tile_ray();
    sample_begin(ray.direction, ray.view);
    Composite sum = composite_begin();
    March march = march_begin((ray.origin - push.box_min.xyz) / push.box_size.xyz, ray.direction / push.box_size.xyz,
                              is_hidden(ray) ? vec2(kFar, 0.0) : ray.range);
    MarchInterval part;
    bool found;
    while (sum.transmittance >= push.box_min.w && march_enter(march))
        while (sum.transmittance >= push.box_min.w && march_on(march, part, found)) {
            if (!found) continue;
            const vec3 colour = sample_colour();
            sigma *= push.density;
            const float before = sum.transmittance;
            part.t_out = max(part.t_in, min(part.t_out, ray.range.y));  // end at the set
            composite_add(sum, sigma, part.t_out - part.t_in, colour, 0.5 * (part.t_in + part.t_out));
            store_interval(ray, part, before, sum.transmittance, kSrgbColours ? srgb_decode(colour) : colour);
        }
    const float alpha = 1.0 - sum.transmittance;
    const float metres = alpha > 0.0 ? sum.depth / alpha : uintBitsToFloat(0x7f800000u);
    if (kSrgbColours && alpha > 0.0) sum.colour = alpha * srgb_decode(sum.colour / alpha);
    store_ray(ray, vec4(sum.colour, alpha), metres, march.steps);
}
