// Lists of intervals: the samples of several instances along the same ray, which merge.comp blends in depth order.
//
// Each ray has a list for each instance that it meets. A list is a chain of pages of kPageWords texels, a header and
// then intervals. The first pages of the buffer have no intervals, but `heads`: the number of pages in use less one,
// then per ray the first page of its first list. Shaders declare them as a second block of the same binding. Page 0,
// which is one of them, means "none" as an index.
//   header.x   the next page of the list, or kLastPage | the number of intervals in this page, which is then the last
//   header.y   in a list's first page: the first page of the ray's next list
//   header.z   in a list's first page: the light that shines on the instance (light_of_bits)
//   header.w   in a list's first page: the texel of the interval that the merge has come to, 0 at the list's end
//   interval.x  where it begins along the ray (bits of a float, world metres); interval.y: where it ends
//   interval.z  optical depth | R << 16; interval.w: G | B << 16 (fp16)
#ifndef NEUVV_SHARED_INTERVALS_H
#define NEUVV_SHARED_INTERVALS_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kPageWords = 8u;  // uvec4
CONSTEXPR uint kPageIntervals = kPageWords - 1u;

CONSTEXPR uint kLastPage = 0x80000000u;

CONSTEXPR uint kFirstHead = 1u;

// merge.comp
CONSTEXPR uint kMergePages = 0u;
CONSTEXPR uint kMergeCovered = 2u;  // as kRangeCovered
CONSTEXPR uint kMergeRadiance = 3u;
CONSTEXPR uint kMergeDepth = 4u;

struct MergePush {
    float stop;       // the transmittance below which a ray ends (0: never)
    uint first_tile;  // the tiles from first_tile to before end_tile are merged
    uint end_tile;
};

NEUVV_SHARED_END
#endif
