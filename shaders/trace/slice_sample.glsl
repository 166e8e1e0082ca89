// Samples of a slice with slots: march_wants stops the walk at live leaves, and sample_colour is the colour of such a
// leaf along the ray. The includer declares the arrays `tree_nodes` and `tree_links`, and calls
// sample_begin for its ray.
#ifndef NEUVV_SLICE_SAMPLE_GLSL
#define NEUVV_SLICE_SAMPLE_GLSL
#include "arrays.glsl"
#include "trace/march.glsl"
#include "slice/sh.glsl"

READ_ARRAY(uvec2, kTraceNodeLive, node_live);
READ_ARRAY(uvec2, kTraceHead, head);
READ_ARRAY(vec4, kTraceSh, slice_sh);

float sh_y[kMaxShCount];
float sigma;  // 1/m, of the leaf that the walk stopped at
uint slot;

void sample_begin(vec3 direction, uint view) { sh_y = sh_basis(direction); }

Node march_node(uint node) {
    const uvec4 entry = FETCH(tree_nodes, int(node));
    return make_node(FETCH(node_live, int(node)).xy, entry.xy, entry.z, entry.w);
}

uint march_child(uint index) { return FETCH(tree_links, int(index)).x; }

bool march_wants(uint leaf) {
    const uvec2 entry = FETCH(head, int(leaf)).xy;
    sigma = uintBitsToFloat(entry.x);
    slot = entry.y;
    return sigma > 0.0;
}

vec3 sample_colour() {
    vec3 raw = vec3(0.0);
    const int first = int(slot * sh_count(kHhDegree));
    for (uint j = 0u; j < sh_count(kHhDegree); ++j) raw += sh_y[j] * FETCH(slice_sh, first + int(j)).rgb;
    return 1.0 / (1.0 + exp(-raw));  // errata 8
}

#endif
