// The colour of one leaf in a slice. The includer binds what weights.glsl asks for, and stores the coefficients.
#ifndef NEUVV_SLICE_LEAF_GLSL
#define NEUVV_SLICE_LEAF_GLSL
#include "weights.glsl"

// The includer's: the coefficient k of SH function j belongs to `place`.
void store_coefficient(uint place, uint j, vec3 k);

void store_band(uint place, uint leaf, uint l, vec4 radial, uint leaf_count) {
    for (uint j = l * l; j < (l + 1u) * (l + 1u); j++)
        store_coefficient(place, j, slice_coefficient(leaf, j, radial, l, leaf_count));
}

// The SH coefficients k_lm (errata 7) of a leaf.
void store_leaf_colour(uint place, uint leaf, uint leaf_count) {
    const HhRadial radial = hh_radial(leaf_gamma(leaf, leaf_count));
    store_band(place, leaf, 0u, radial.l0, leaf_count);
    if (kHhDegree >= 1u) store_band(place, leaf, 1u, radial.l1, leaf_count);
    if (kHhDegree >= 2u) store_band(place, leaf, 2u, radial.l2, leaf_count);
    if (kHhDegree >= 3u) store_band(place, leaf, 3u, radial.l3, leaf_count);
}

#endif
