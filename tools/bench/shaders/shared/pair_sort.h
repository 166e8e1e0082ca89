// Sort of pairs (key of 64 bits, value of 32) by their keys: a stable radix sort, six bits a round.
#ifndef NEUVV_SHARED_PAIR_SORT_H
#define NEUVV_SHARED_PAIR_SORT_H
#include "shared/types.h"

NEUVV_SHARED

CONSTEXPR uint kSortGroup = 64u;
CONSTEXPR uint kSortDigitBits = 6u;
CONSTEXPR uint kSortDigits = 64u;   // one a thread
CONSTEXPR uint kSortPlaces = 11u;   // digits of a key
CONSTEXPR uint kSortBlock = 1024u;  // pairs a workgroup

CONSTEXPR uint kSortKeys = 0u;         // (low, high) words
CONSTEXPR uint kSortValues = 1u;       // pair_sort_scatter.comp alone
CONSTEXPR uint kSortCount = 2u;        // a LiveCount: slots are pairs, its groups their blocks
CONSTEXPR uint kSortBlockCounts = 3u;  // per digit and block: pairs; scanned, where the first of them goes
CONSTEXPR uint kSortDigitCounts = 4u;  // per place and digit: pairs
CONSTEXPR uint kSortKeysOut = 5u;
CONSTEXPR uint kSortValuesOut = 6u;

struct PairSortPush {
    uint place;     // of the digit, from the lowest
    uint capacity;  // pairs
    uint stride;    // block_counts of a digit
};

NEUVV_SHARED_END

#ifdef __cplusplus
static_assert(neuvv::kSortDigits == 1u << neuvv::kSortDigitBits && neuvv::kSortDigits == neuvv::kSortGroup);
static_assert(neuvv::kSortPlaces * neuvv::kSortDigitBits >= 64);
#endif
#endif
