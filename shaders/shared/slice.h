// The slice passes: from a VOctree to σ and SH of each live leaf at one frame (errata 7).
#ifndef NEUVV_SHARED_SLICE_H
#define NEUVV_SHARED_SLICE_H
#include "shared/field.h"

NEUVV_SHARED

CONSTEXPR uint kSliceGroup = 64u;
CONSTEXPR uint kLeavesPerThread = 4u;  // in slice_density.comp

// rows.comp: interpolates A and B (errata 9).
CONSTEXPR uint kRowsSigmaBasis = 0u;
CONSTEXPR uint kRowsGammaBasis = 1u;
CONSTEXPR uint kRowsOut = 2u;
CONSTEXPR uint kRowsLive = 3u;

// slice_density.comp and slice_colour.comp
CONSTEXPR uint kSliceWeights = 0u;
CONSTEXPR uint kSliceRows = 1u;
CONSTEXPR uint kSliceHead = 2u;    // per leaf: (σ bits, slot); σ 0 where the leaf is dead
CONSTEXPR uint kSliceLeaves = 3u;  // per slot: its leaf
CONSTEXPR uint kSliceLive = 4u;
CONSTEXPR uint kSliceLeafCells = 6u;  // per leaf: (word of kSliceNodeLive, its bits there)
CONSTEXPR uint kSliceNodeLive = 7u;   // per node: mask_lo and mask_hi of the cells that hold live leaves or nodes
CONSTEXPR uint kSliceSh = 5u;         // per slot: (n_max+1)² texels (R, G, B, unused)

struct RowsPush {
    float frame;  // 0..frames−1, clamped
    uint frames;
    uint bases;
    uint part_planes_log2;
    uvec4 weights[kMostWeightParts / 2u];  // BasisRows takes over both
};

struct SlicePush {
    uint leaf_count;
    uint capacity;    // slots
    uint first_leaf;  // slice_density.comp works on the leaves from first_leaf to before end_leaf
    uint end_leaf;
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::SlicePush) == 16 && sizeof(neuvv::RowsPush) == 80);
#endif
#endif
