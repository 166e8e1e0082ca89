// Computes the colour of a leaf in a slice. The includer binds what weights.glsl needs, and defines store_coefficient.
#ifndef NEUVV_SLICE_LEAF_GLSL
#define NEUVV_SLICE_LEAF_GLSL
#include "slice/weights.glsl"

// Stores the coefficient k of SH function j; `target` is the slot or entry that the includer passed to
// store_leaf_colour.
void store_coefficient(uint target, uint j, vec3 k);

void store_band(uint target, uint leaf, uint l, vec4 radial, uint leaf_count) {
    for (uint j = l * l; j < (l + 1u) * (l + 1u); ++j)
        store_coefficient(target, j, slice_coefficient(leaf, j, radial, l, leaf_count));
}

// Computes and stores the SH coefficients k_lm (errata 7) of a leaf.
void store_leaf_colour(uint target, uint leaf, uint leaf_count) {
    const HhRadial radial = hh_radial(leaf_gamma(leaf, leaf_count));
    store_band(target, leaf, 0u, radial.l0, leaf_count);
    if (kHhDegree >= 1u) store_band(target, leaf, 1u, radial.l1, leaf_count);
    if (kHhDegree >= 2u) store_band(target, leaf, 2u, radial.l2, leaf_count);
    if (kHhDegree >= 3u) store_band(target, leaf, 3u, radial.l3, leaf_count);
}

#endif
