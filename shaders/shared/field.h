// A VOctree in device memory, as rendering and training bind it.
//
// Weights are stored in planes of four weights per leaf: texel(leaf, plane) = plane * leaf_count + leaf, so that
// neighbouring threads read neighbouring texels. The planes are ⌈C/4⌉ of w^σ, ⌈C/4⌉ of w^γ, then one plane (R, G, B,
// unused) per HH function. Where a device does not bind or allocate as much at once, they are several parts of whole
// planes.
#ifndef NEUVV_SHARED_FIELD_H
#define NEUVV_SHARED_FIELD_H
#include "shared/hh_counts.h"
#include "shared/tree.h"

NEUVV_SHARED

CONSTEXPR uint kMostWeightParts = 8u;

// Rows A_t and B_t at one (fractional) frame, a uniform buffer. The planes of a row that are not all 0 come first, so
// that loops need only run over the first Field::busy_planes elements; the other elements are 0, and their `planes` are
// valid. Before training spreads a basis over several frames, most planes of a row are 0.
struct BasisRows {
    vec4 sigma[kMaxBasisPlanes];
    vec4 gamma[kMaxBasisPlanes];
    uvec4 planes[kMaxBasisPlanes];  // x: the plane of w^σ that sigma[i] belongs to, y: that of w^γ for gamma[i]
    // Where weights are read by address: the addresses of their parts, two in each element, the low and the high word
    // of the one, then of the other. Part i has the planes from i << part_planes_log2 on.
    uvec4 weights[kMostWeightParts / 2u];
    uint part_planes_log2;
    uint unused_0, unused_1, unused_2;
};

// A counter of list elements, for instance of live leaves. The first three members are arguments of dispatch_indirect.
struct LiveCount {
    uint groups_x;
    uint groups_y;
    uint groups_z;
    uint slots;     // elements, including those for which there was no room: use min(slots, capacity)
    uint overflow;  // elements for which there was no room; if not 0, the list is incomplete
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::BasisRows) == 848);
static_assert(sizeof(neuvv::LiveCount) == 20);
#endif
#endif
