// Sorts pairs of a 64-bit key and a 32-bit value by their keys: a stable radix sort by a digit of six bits per round.
#ifndef NEUVV_SHARED_PAIR_SORT_H
#define NEUVV_SHARED_PAIR_SORT_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kSortGroup = 64u;
CONSTEXPR uint kSortDigitBits = 6u;
CONSTEXPR uint kSortDigits = 64u;   // values of a digit; one per thread
CONSTEXPR uint kSortRounds = 11u;   // digits of a 64-bit key
CONSTEXPR uint kSortBlock = 1024u;  // pairs per workgroup

CONSTEXPR uint kSortKeys = 0u;         // (low word, high word)
CONSTEXPR uint kSortValues = 1u;       // only in pair_sort_scatter.comp
CONSTEXPR uint kSortCount = 2u;        // a LiveCount: slots are pairs, groups_x their blocks
CONSTEXPR uint kSortBlockCounts = 3u;  // per digit and block: pairs; after the scan, where they go
CONSTEXPR uint kSortDigitCounts = 4u;  // per round and digit: the number of pairs
CONSTEXPR uint kSortKeysOut = 5u;
CONSTEXPR uint kSortValuesOut = 6u;

struct PairSortPush {
    uint round;     // which is the number of its digit, from the lowest
    uint capacity;  // pairs
    uint stride;    // from one digit to the next in block_counts
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(neuvv::kSortDigits == 1u << neuvv::kSortDigitBits && neuvv::kSortDigits == neuvv::kSortGroup);
static_assert(neuvv::kSortRounds * neuvv::kSortDigitBits >= 64);
#endif
#endif
