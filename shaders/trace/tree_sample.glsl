// Samples of a slice tree (shared/slice_tree.h): sample_colour is the colour of the leaf along the ray, with kShaded
// the one that its entry has, and with kColourless 0. The includer declares the arrays `nodes` and `entries`, and
// calls sample_begin for its ray.
#ifndef NEUVV_TREE_SAMPLE_GLSL
#define NEUVV_TREE_SAMPLE_GLSL
#include "arrays.glsl"
#include "trace/march.glsl"
#include "slice/sh.glsl"

float sh_y[kMaxShCount];
float sigma;  // 1/m, of the leaf that the walk stopped at
uint entry;
uvec2 entry_words;
uint view_entries;  // from an entry's index to that of the view's shaded entry

void sample_begin(vec3 direction, uint view) {
    sh_y = sh_basis(direction);
    view_entries = view * push.shaded_stride - push.entry_base;
}

Node march_node(uint node) {
    const uvec4 words = FETCH(nodes, int(push.node_base + node));
    return make_node(words.xy, words.xy, words.z, words.w);
}

uint march_child(uint index) {
    entry = kShaded ? index + view_entries : index * sh_count(kHhDegree);
    entry_words = FETCH(entries, int(entry)).xy;
    return (entry_words.x & kEntryIsNode) != 0u ? entry_words.y : kLeafBit;
}

bool march_wants(uint leaf) {
    sigma = unpackHalf2x16(entry_words.x).x;
    return true;
}

vec3 entry_colour(uvec2 words) { return vec3(unpackHalf2x16(words.x).y, unpackHalf2x16(words.y)); }

vec3 sample_colour() {
    if (kColourless) return vec3(0.0);
    if (kShaded) return entry_colour(entry_words);
    vec3 raw = sh_y[0] * entry_colour(entry_words);
    for (uint j = 1u; j < sh_count(kHhDegree); ++j)
        raw += sh_y[j] * entry_colour(FETCH(entries, int(entry + j)).xy);
    return 1.0 / (1.0 + exp(-raw));  // errata 8
}

#endif
