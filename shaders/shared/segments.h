// Segments of rays that several instances put there, to be blended together in depth order (merge.comp).
//
// A page is kPageWords texels: a header, then segments. Header: x the next page of the list, or kLastPage | the number
// of its segments; of a list's first page y the first page of the ray's next list, z the light that shines on it as
// light_of_bits says, w where the merge has come to in the list (0 at its end). Segment: x, y where it begins and ends
// along the ray (bits of floats, world metres), z its optical depth | R << 16, w G | B << 16, fp16. Page 0 is none.
#ifndef NEUVV_SHARED_SEGMENTS_H
#define NEUVV_SHARED_SEGMENTS_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kPageWords = 8u;  // uvec4
CONSTEXPR uint kPageSegments = kPageWords - 1u;

CONSTEXPR uint kLastPage = 0x80000000u;

// Heads: the pages that are taken, then per ray the first page of its first list.
CONSTEXPR uint kFirstHead = 1u;

// merge.comp
CONSTEXPR uint kMergePages = 0u;
CONSTEXPR uint kMergeHeads = 1u;
CONSTEXPR uint kMergeCovered = 2u;  // as kRangeCovered
CONSTEXPR uint kMergeRadiance = 3u;
CONSTEXPR uint kMergeDepth = 4u;

struct MergePush {
    float stop;       // rays stop where transmittance falls below this (0: never)
    uint first_tile;  // of those that are merged, and their end
    uint end_tile;
};

NEUVV_SHARED_END
#endif
