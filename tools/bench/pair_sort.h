// Pair sort: sorts pairs of a 64-bit key and a 32-bit value by their keys, on the device; the result does not depend on
// the size of its subgroups.
#pragma once

#include <array>

#include "gpu/commands.h"
#include "shared/field.h"
#include "shared/pair_sort.h"

namespace neuvv::bench {

// Pairs on the device. Each round of the sort moves them from one of the two buffers to the other.
struct SortPairs {
    // Throws RuntimeFailure where the device cannot hold or dispatch so many.
    SortPairs(const gpu::Device& device, uint32_t pair_capacity);

    uint32_t capacity;
    std::array<gpu::Buffer, 2> keys;    // (low word, high word)
    std::array<gpu::Buffer, 2> values;  // the pairs to sort are the first of each
    gpu::Buffer count;                  // LiveCount: slots are the pairs, groups_x their blocks of kSortBlock
    gpu::Buffer block_counts, digit_counts;
};

struct PairSorter {
    PairSorter(const gpu::Device& device, const SortPairs& pairs);

    const SortPairs& pairs;
    gpu::ComputePass count, scan, scatter;
    std::array<gpu::BindingSet, 2> count_sets, scatter_sets;  // from the first buffers, from the second
    gpu::BindingSet scan_set;
};

// Sorts by the lowest `key_bits` bits. Pairs of equal keys stay in their order.
void record_pair_sort(gpu::Commands& commands, const PairSorter& sorter, uint32_t key_bits);

// Index of the buffers that hold the pairs when they are sorted.
constexpr uint32_t sorted_buffer(uint32_t key_bits) {
    return (key_bits + kSortDigitBits - 1) / kSortDigitBits % 2;
}

}  // namespace neuvv::bench
