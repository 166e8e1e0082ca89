// dequantise.comp: from the planes of a slice in whole numbers (stream/codec/quantised_slice.h) to the entries of a
// slice tree (slice_tree.h).
#ifndef NEUVV_SHARED_DEQUANTISE_H
#define NEUVV_SHARED_DEQUANTISE_H
#include "shared/slice_tree.h"

NEUVV_SHARED

CONSTEXPR uint kDequantisePlanes = 0u;     // two numbers a word; each plane begins with a word of its own
CONSTEXPR uint kDequantiseEntries = 1u;    // per leaf: its entry, or kNoLeaf
CONSTEXPR uint kDequantisePositions = 2u;  // per leaf: as Field::leaf_positions
CONSTEXPR uint kDequantiseNodes = 3u;      // per node but the root: its entry, and its number
CONSTEXPR uint kDequantiseTables = 4u;
CONSTEXPR uint kDequantiseOut = 5u;
CONSTEXPR uint kDequantiseLeaves = 6u;  // per entry: its leaf, or kNoLeaf

// The tables, one behind the other. By twice the mean sRGB of a channel (slice::ColourCurves): k_00, and for each
// degree how much a unit is of a coefficient. Then σ in 1/m, by depth and opacity.
CONSTEXPR uint kMeanCount = 2047u;
CONSTEXPR uint kOpacityCount = 1024u;
CONSTEXPR uint kTablePerUnit = kMeanCount;
CONSTEXPR uint kTableSigma = kMeanCount * 5u;

struct DequantisePush {
    uint leaves;
    uint nodes;         // without the root
    uint plane_words;   // words of a plane
    uint levels_above;  // how much deeper leaves lie than in the slice: Field::levels_above
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::DequantisePush) == 16);
#endif
#endif
