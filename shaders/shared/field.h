// A VOctree in device memory, as rendering and training bind it.
//
// Weights are planes of four: texel(leaf, plane) = plane * leaf_count + leaf, so that neighbouring threads read
// neighbouring texels. Planes of a leaf: w^σ in ⌈C/4⌉, w^γ in ⌈C/4⌉, then one plane (R, G, B, unused) per HH function.
#ifndef NEUVV_SHARED_FIELD_H
#define NEUVV_SHARED_FIELD_H
#include "shared/hh_counts.h"
#include "shared/tree.h"

NEUVV_SHARED

CONSTEXPR uint kMaxBasisPlanes = kMaxBases / 4u;

// Rows A_t and B_t at one (fractional) frame; a uniform buffer. Bases that training has not spread are 0 in most
// planes: those that are not stand first, and the rest is 0 in the first one's place, so that loops over
// Field::busy_planes miss nothing.
struct BasisRows {
    vec4 sigma[kMaxBasisPlanes];
    vec4 gamma[kMaxBasisPlanes];
    uvec4 planes[kMaxBasisPlanes];  // x: which plane sigma[i] belongs to, y: gamma[i]
};

// Counters that the slice pass leaves behind; the first three words are arguments of dispatch_indirect.
struct LiveCount {
    uint groups_x;
    uint groups_y;
    uint groups_z;
    uint slots;     // live leaves of this frame, those without a slot included: take min(slots, capacity)
    uint overflow;  // live leaves that found no slot (then the slice is incomplete)
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::BasisRows) == 768);
static_assert(sizeof(neuvv::LiveCount) == 20);
#endif
#endif
