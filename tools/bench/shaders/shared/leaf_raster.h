// Draws the live leaves of a shaded slice tree without tracing rays: pairs of a tile and a leaf that the tile's rays
// may meet are sorted, and composited tile by tile (after SVRaster).
//
// A pair's key is tile << 6·kNodeLevels | nearness. The nearness is the Morton number of the leaf's cell, its bits
// flipped by the side of the eye (leaf_key.glsl), so that the leaves of a tile are sorted front to back along every ray
// from the eye. The pair's value is the leaf's entry, counted from the first of its slice. No two pairs have the same
// key.
#ifndef NEUVV_SHARED_LEAF_RASTER_H
#define NEUVV_SHARED_LEAF_RASTER_H
#include "shared/pair_sort.h"
#include "shared/slice_tree.h"

NEUVV_SHARED

// leaf_pairs.comp and leaf_composite.comp
struct LeafRasterPush {
    vec4 eye;    // world, metres; w: rays of a pixel along each side
    vec4 row_x;  // as in RangeView
    vec4 row_y;
    vec4 row_z;
    vec4 box_min;   // metres; w: rays stop where transmittance falls below this (0: never)
    vec4 box_size;  // metres
    uint width;     // of the image of rays
    uint height;
    uint slice;
    uint entry_capacity;  // of a slice
    uint capacity;        // pairs
};

// leaf_pairs.comp
CONSTEXPR uint kPairsLeaves = 0u;     // per entry of the slices: its leaf
CONSTEXPR uint kPairsPositions = 1u;  // per leaf: as Field::leaf_positions
CONSTEXPR uint kPairsEntries = 2u;    // per slice: a LiveCount of entries
CONSTEXPR uint kPairsKeys = 3u;
CONSTEXPR uint kPairsValues = 4u;
CONSTEXPR uint kPairsCount = 5u;  // as kSortCount; slots count all pairs, also those beyond the capacity

// leaf_tiles.comp
CONSTEXPR uint kLeafTilesKeys = 0u;
CONSTEXPR uint kLeafTilesCount = 1u;
CONSTEXPR uint kLeafTilesOut = 2u;     // per tile that has pairs: (its first, the first after its last)
CONSTEXPR uint kLeafTilesList = 3u;    // the tiles that have pairs, then kNoTile
CONSTEXPR uint kLeafTilesListed = 4u;  // a LiveCount of these tiles

struct LeafTilesPush {
    uint capacity;  // pairs
};

// leaf_composite.comp: kTraceCameras, kTraceTiles, kTraceTileList, kTraceRadiance, kTraceDepth, and
CONSTEXPR uint kCompositePairs = 0u;  // per tile: as kLeafTilesOut
CONSTEXPR uint kCompositeValues = 1u;
CONSTEXPR uint kCompositeEntries = 2u;  // the shaded entries
CONSTEXPR uint kCompositeLeaves = 3u;
CONSTEXPR uint kCompositePositions = 8u;

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::LeafRasterPush) == 116);
#endif
#endif
