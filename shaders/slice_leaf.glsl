// The colour of one leaf in a slice. The includer binds what weights.glsl asks for, and imageBuffer `slice_sh` (rgba32f).
#ifndef NEUVV_SLICE_LEAF_GLSL
#define NEUVV_SLICE_LEAF_GLSL
#include "weights.glsl"

void store_slice_band(uint slot, uint leaf, uint l, vec4 radial, uint leaf_count) {
    for (uint j = l * l; j < (l + 1u) * (l + 1u); j++) {
        const vec3 k = slice_coefficient(leaf, j, radial, l, leaf_count);
        imageStore(slice_sh, int(slot * sh_count(kHhDegree) + j), vec4(k, 0.0));
    }
}

// The SH coefficients k_lm (errata 7) of a leaf, into its slot.
void store_slice_colour(uint slot, uint leaf, uint leaf_count) {
    const HhRadial radial = hh_radial(leaf_gamma(leaf, leaf_count));
    store_slice_band(slot, leaf, 0u, radial.l0, leaf_count);
    if (kHhDegree >= 1u) store_slice_band(slot, leaf, 1u, radial.l1, leaf_count);
    if (kHhDegree >= 2u) store_slice_band(slot, leaf, 2u, radial.l2, leaf_count);
    if (kHhDegree >= 3u) store_slice_band(slot, leaf, 3u, radial.l3, leaf_count);
}

#endif
