#include "tools/bench/pair_sort.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"
#include "spirv/pair_sort_count.comp.h"
#include "spirv/pair_sort_scan.comp.h"
#include "spirv/pair_sort_scatter.comp.h"

namespace neuvv::bench {

namespace {

gpu::Buffer keys_buffer(const gpu::Device& device, const char* name, uint32_t pairs) {
    return gpu::Buffer(device, name, uint64_t{8} * pairs, gpu::MemoryKind::kDevice, VK_FORMAT_R32G32_UINT);
}

gpu::Buffer values_buffer(const gpu::Device& device, const char* name, uint32_t pairs) {
    return gpu::Buffer(device, name, uint64_t{4} * pairs, gpu::MemoryKind::kDevice, VK_FORMAT_R32_UINT);
}

void check_limits(const gpu::Device& device, uint32_t pairs) {
    if (gpu::groups_of(pairs, kSortBlock) > device.limits().maxComputeWorkGroupCount[0])
        throw RuntimeFailure(fmt::format("{} pairs are more than this device can sort", pairs));
}

}  // namespace

SortPairs::SortPairs(const gpu::Device& device, uint32_t pair_capacity)
    : capacity(std::max(pair_capacity, 1u)),
      keys{keys_buffer(device, "pair keys", capacity), keys_buffer(device, "pair keys, other", capacity)},
      values{values_buffer(device, "pair values", capacity), values_buffer(device, "pair values, other", capacity)},
      count(device, "count of pairs", sizeof(LiveCount), gpu::MemoryKind::kDevice),
      block_counts(device, "digits of blocks", uint64_t{4} * kSortDigits * gpu::groups_of(capacity, kSortBlock),
                   gpu::MemoryKind::kDevice),
      digit_counts(device, "digits of pairs", uint64_t{4} * kSortDigits * kSortRounds, gpu::MemoryKind::kDevice) {
    check_limits(device, capacity);
}

PairSorter::PairSorter(const gpu::Device& device, const SortPairs& given_pairs)
    : pairs(given_pairs),
      count(device, "pair sort count", pair_sort_count_comp),
      scan(device, "pair sort scan", pair_sort_scan_comp),
      scatter(device, "pair sort scatter", pair_sort_scatter_comp),
      scan_set(scan, {{kSortCount, &pairs.count},
                      {kSortBlockCounts, &pairs.block_counts},
                      {kSortDigitCounts, &pairs.digit_counts}}) {
    for (uint32_t from = 0; from < 2; ++from) {
        count_sets[from] = gpu::BindingSet(count, {{kSortKeys, &pairs.keys[from]},
                                                   {kSortCount, &pairs.count},
                                                   {kSortBlockCounts, &pairs.block_counts},
                                                   {kSortDigitCounts, &pairs.digit_counts}});
        scatter_sets[from] = gpu::BindingSet(scatter, {{kSortKeys, &pairs.keys[from]},
                                                       {kSortValues, &pairs.values[from]},
                                                       {kSortCount, &pairs.count},
                                                       {kSortBlockCounts, &pairs.block_counts},
                                                       {kSortKeysOut, &pairs.keys[1 - from]},
                                                       {kSortValuesOut, &pairs.values[1 - from]}});
    }
}

void record_pair_sort(gpu::Commands& commands, const PairSorter& sorter, uint32_t key_bits) {
    const SortPairs& pairs = sorter.pairs;
    gpu::fill(commands, pairs.digit_counts, 0);
    gpu::compute_barrier(commands);
    for (uint32_t round = 0; round * kSortDigitBits < key_bits; ++round) {
        const uint32_t from = round % 2;
        const PairSortPush push{round, pairs.capacity, gpu::groups_of(pairs.capacity, kSortBlock)};
        gpu::dispatch_indirect(commands, sorter.count, sorter.count_sets[from], pairs.count, 0, push);
        gpu::compute_barrier(commands);
        gpu::dispatch_groups(commands, sorter.scan, sorter.scan_set, kSortDigits, push);
        gpu::compute_barrier(commands);
        gpu::dispatch_indirect(commands, sorter.scatter, sorter.scatter_sets[from], pairs.count, 0, push);
        gpu::compute_barrier(commands);
    }
}

}  // namespace neuvv::bench
