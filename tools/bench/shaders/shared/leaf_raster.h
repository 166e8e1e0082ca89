// Live leaves of a shaded slice tree as sparse voxels: pairs of a tile and a leaf that its rays may meet, sorted, and
// composited tile by tile (after SVRaster).
//
// A pair's key is tile << 6·kNodeLevels | nearness, nearness the Morton number of the leaf's place as seen from the eye
// (leaf_key.glsl): leaves of a tile stand in an order that is front to back along every ray from the eye. Its value is
// the leaf's entry, counted from its slice's first. No two pairs have the same key.
#ifndef NEUVV_SHARED_LEAF_RASTER_H
#define NEUVV_SHARED_LEAF_RASTER_H
#include "shared/pair_sort.h"
#include "shared/slice_tree.h"

NEUVV_SHARED

// leaf_pairs.comp and leaf_composite.comp
struct LeafRasterPush {
    vec4 eye;    // world, metres; w: rays of an image's pixel along each side
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
CONSTEXPR uint kPairsLeaves = 0u;   // per entry of the slices: its leaf
CONSTEXPR uint kPairsPlaces = 1u;   // per leaf: as Field::leaf_positions
CONSTEXPR uint kPairsEntries = 2u;  // per slice: a LiveCount of entries
CONSTEXPR uint kPairsKeys = 3u;
CONSTEXPR uint kPairsValues = 4u;
CONSTEXPR uint kPairsCount = 5u;  // as kSortCount; slots are those wanted, be there room or not

// leaf_tiles.comp
CONSTEXPR uint kLeafTilesKeys = 0u;
CONSTEXPR uint kLeafTilesCount = 1u;
CONSTEXPR uint kLeafTilesOut = 2u;     // per tile that has pairs: (its first, the first after its last)
CONSTEXPR uint kLeafTilesList = 3u;    // these tiles, then kNoTile
CONSTEXPR uint kLeafTilesListed = 4u;  // a LiveCount of them

struct LeafTilesPush {
    uint capacity;  // pairs
};

// leaf_composite.comp: kTraceCameras, kTraceTiles, kTraceTileList, kTraceRadiance, kTraceDepth, and
CONSTEXPR uint kCompositePairs = 0u;  // per tile: as kLeafTilesOut
CONSTEXPR uint kCompositeValues = 1u;
CONSTEXPR uint kCompositeEntries = 2u;  // shaded
CONSTEXPR uint kCompositeLeaves = 3u;
CONSTEXPR uint kCompositePlaces = 8u;

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(sizeof(neuvv::LeafRasterPush) == 116);
#endif
#endif
