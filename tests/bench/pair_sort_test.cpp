// The pair sort against std::stable_sort.
#include "tools/bench/pair_sort.h"
#include "gpu/host_copies.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "base/error.h"
#include "support/gpu_test.h"
#include "support/random_tree.h"

namespace neuvv::test {
namespace {

using Key = uint64_t;

struct SortedPairs {
    std::vector<Key> keys;
    std::vector<uint32_t> values;
};

// The values are the indices of the keys. A key on the device is (low word, high word), as a Key is on this host.
SortedPairs sort_on_device(const gpu::Device& device, const std::vector<Key>& keys, uint32_t capacity,
                           uint32_t key_bits) {
    const bench::SortPairs pairs(device, capacity);
    const bench::PairSorter sorter(device, pairs);
    const auto count = static_cast<uint32_t>(keys.size());
    SortedPairs sorted{std::vector<Key>(count), std::vector<uint32_t>(count)};
    std::iota(sorted.values.begin(), sorted.values.end(), 0u);
    const LiveCount live{(count + kSortBlock - 1) / kSortBlock, 1, 1, count, 0};
    gpu::upload(device, pairs.keys[0], keys.data(), count * sizeof(Key));
    gpu::upload(device, pairs.values[0], sorted.values.data(), count * sizeof(uint32_t));
    gpu::upload(device, pairs.count, &live, sizeof(live));
    gpu::run_once(device, "sort",
                  [&](gpu::Commands& commands) { bench::record_pair_sort(commands, sorter, key_bits); });
    gpu::download(device, pairs.keys[bench::sorted_buffer(key_bits)], sorted.keys.data(), count * sizeof(Key));
    gpu::download(device, pairs.values[bench::sorted_buffer(key_bits)], sorted.values.data(), count * sizeof(uint32_t));
    return sorted;
}

void expect_sorted(const gpu::Device& device, const std::vector<Key>& keys, uint32_t capacity, uint32_t key_bits) {
    SCOPED_TRACE(std::to_string(keys.size()) + " pairs, " + std::to_string(key_bits) + " bits");
    const uint32_t digits = (key_bits + kSortDigitBits - 1) / kSortDigitBits;
    const Key mask = ~Key{0} >> (64 - std::min(64u, digits * kSortDigitBits));  // keys are sorted by whole digits
    std::vector<uint32_t> order(keys.size());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(),
                     [&](uint32_t a, uint32_t b) { return (keys[a] & mask) < (keys[b] & mask); });
    const SortedPairs sorted = sort_on_device(device, keys, capacity, key_bits);
    ASSERT_EQ(sorted.values, order);
    for (size_t i = 0; i < keys.size(); ++i) ASSERT_EQ(sorted.keys[i], keys[order[i]]) << "pair " << i;
}

std::vector<Key> random_keys(uint64_t seed, size_t count, uint32_t bits) {
    Random random(seed);
    std::vector<Key> keys(count);
    for (Key& key : keys) key = random.engine() >> (64 - bits);
    return keys;
}

using PairSortTest = GpuTest;

TEST_F(PairSortTest, SortsAnyNumberByAnyBits) {
    for (const uint32_t bits : {5u, 8u, 20u, 33u, 44u, 64u})
        for (const uint32_t count : {0u, 1u, 63u, 64u, 1024u, 1025u, 50001u})
            expect_sorted(device(), random_keys(bits + count, count, bits), count + 1000, bits);
}

TEST_F(PairSortTest, PairsOfEqualKeysStayInOrder) {
    expect_sorted(device(), std::vector<Key>(20000, 0x0123456789abcdef), 20000, 64);
    expect_sorted(device(), random_keys(1, 30000, 3), 30000, 8);
}

TEST_F(PairSortTest, ManyPairsHaveManyBlocks) {
    const uint32_t count = 300 * kSortBlock + 13;  // more blocks than the scan handles in one round
    expect_sorted(device(), random_keys(2, count, 20), count, 16);
}

TEST_F(PairSortTest, MorePairsThanADeviceHoldsAreRefused) {
    EXPECT_THROW(bench::SortPairs(device(), UINT32_MAX), RuntimeFailure);
}

}  // namespace
}  // namespace neuvv::test
