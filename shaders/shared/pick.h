// The pick pass: rays of their own through a slice tree, each to the leaf where it has met enough.
#ifndef NEUVV_SHARED_PICK_H
#define NEUVV_SHARED_PICK_H
#include "shared/slice_tree.h"

NEUVV_SHARED

CONSTEXPR uint kPickGroup = 64u;
CONSTEXPR uint kPickTop = 0u;
CONSTEXPR uint kPickNodes = 1u;
CONSTEXPR uint kPickEntries = 2u;
CONSTEXPR uint kPickLeaves = 3u;  // per entry its leaf
CONSTEXPR uint kPickRays = 4u;    // a PickRay each: two texels
CONSTEXPR uint kPickOut = 5u;     // a Pick each: one texel

// In the performer's space, metres.
struct PickRay {
    vec4 origin;
    vec4 direction;  // unit
};

struct Pick {
    uint leaf;    // kNoLeaf: the ray never meets enough
    uint metres;  // bits of the distance from its origin
};

struct PickPush {
    vec4 box_min;   // metres; w: transmittance at which a ray has met enough
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
static_assert(sizeof(neuvv::Pick) == 8);
static_assert(sizeof(neuvv::PickPush) == 56);
#endif
#endif
