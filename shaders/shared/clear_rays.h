// The passes that clear the rays of a frame: only those in tiles that the last frame's instances may have covered.
#ifndef NEUVV_SHARED_CLEAR_RAYS_H
#define NEUVV_SHARED_CLEAR_RAYS_H
#include "shared/slice_tree.h"
#include "shared/trace.h"

NEUVV_SHARED

CONSTEXPR uint kClearCovered = 0u;   // as kRangeCovered
CONSTEXPR uint kClearList = 1u;      // the tiles to clear, then kNoTile
CONSTEXPR uint kClearCount = 2u;     // a LiveCount of the list
CONSTEXPR uint kClearRadiance = 3u;  // as kTraceRadiance
CONSTEXPR uint kClearDepth = 4u;     // as kTraceDepth

struct CoveredListPush {
    uint tiles;
};

NEUVV_SHARED_END

#endif
