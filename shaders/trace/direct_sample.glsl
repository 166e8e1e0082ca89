// Samples of a field without a slice: march_wants stops the walk at leaves with σ > 0, and sample_colour is the colour
// of such a leaf along the ray. The includer binds what weights.glsl needs, has `push.leaf_count`, and calls
// sample_begin for its ray.
#ifndef NEUVV_DIRECT_SAMPLE_GLSL
#define NEUVV_DIRECT_SAMPLE_GLSL
#include "arrays.glsl"
#include "trace/march.glsl"
#include "slice/sh.glsl"
#include "slice/weights.glsl"

float sh_y[kMaxShCount];
uint at_leaf;  // the leaf that the walk stopped at
float sigma;  // its density

void sample_begin(vec3 direction, uint view) { sh_y = sh_basis(direction); }

// Σ_nm w_nlm H_nlm(d, γ) for one l
vec3 band(uint leaf, uint l, vec4 radial) {
    vec3 raw = vec3(0.0);
    for (uint n = l; n <= kHhDegree; ++n)
        for (uint j = l * l; j < (l + 1u) * (l + 1u); ++j)
            raw += radial[n] * sh_y[j] * leaf_hh(leaf, kHhBase[n] + j, push.leaf_count);
    return raw;
}

vec3 sample_colour() {
    const HhRadial radial = hh_radial(leaf_gamma(at_leaf, push.leaf_count));
    vec3 raw = band(at_leaf, 0u, radial.l0);
    if (kHhDegree >= 1u) raw += band(at_leaf, 1u, radial.l1);
    if (kHhDegree >= 2u) raw += band(at_leaf, 2u, radial.l2);
    if (kHhDegree >= 3u) raw += band(at_leaf, 3u, radial.l3);
    return 1.0 / (1.0 + exp(-raw));
}

Node march_node(uint node) {
    const uvec4 entry = FETCH(tree_nodes, int(node));
    return make_node(entry.xy, entry.xy, entry.z, entry.w);
}

uint march_child(uint index) { return FETCH(tree_links, int(index)).x; }

bool march_wants(uint leaf) {
    at_leaf = leaf;
    sigma = leaf_sigma(leaf, push.leaf_count);
    return sigma > 0.0;
}

#endif
