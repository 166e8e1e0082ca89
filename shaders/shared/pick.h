// The pick pass: traces given rays through a slice tree, each to the leaf in which its transmittance falls below a
// threshold.
#ifndef NEUVV_SHARED_PICK_H
#define NEUVV_SHARED_PICK_H
#include "shared/slice_tree.h"

NEUVV_SHARED

CONSTEXPR uint kPickGroup = 64u;
CONSTEXPR uint kPickLinks = 0u;
CONSTEXPR uint kPickNodes = 1u;
CONSTEXPR uint kPickEntries = 2u;
CONSTEXPR uint kPickLeaves = 3u;  // per entry its leaf
CONSTEXPR uint kPickRays = 4u;    // per ray a PickRay: two texels
CONSTEXPR uint kPickOut = 5u;     // per ray a Pick: one texel

// In the performer's space, metres.
struct PickRay {
    vec4 origin;
    vec4 direction;  // unit
};

struct Pick {
    uint leaf;    // kNoLeaf: the ray's transmittance stays above the threshold
    uint metres;  // bits of the float distance from the ray's origin to where it reaches the threshold
    // fp16 linear RGB of the surface (packHalf2x16: red and green; blue): what the ray sees down to the threshold,
    // divided by its alpha there. 0 in a pass without colours.
    uint red_green, blue;
};

struct PickPush {
    vec4 box_min;   // metres; w: the threshold of transmittance
    vec4 box_size;  // metres
    TopBox top;
    uint node_base;
    uint entry_base;
    uint shaded_stride;
    uint rays;
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::PickRay) == 32);
static_assert(sizeof(neuvv::Pick) == 16);
static_assert(sizeof(neuvv::PickPush) == 56);
#endif
#endif
