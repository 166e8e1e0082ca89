// Symbols as bytes and back.
#include "stream/codec/rans.h"

#include <gtest/gtest.h>

#include <cmath>

#include "stream/codec/symbols.h"
#include "support/random_tree.h"

namespace neuvv::test::rans_test {
namespace {

// How often each of 20 symbols comes: from nearly always to once.
std::vector<uint32_t> uneven_counts() {
    std::vector<uint32_t> counts;
    for (int i = 0; i < 20; ++i) counts.push_back(i % 7 == 3 ? 0 : static_cast<uint32_t>(100'000 >> i) + 1);
    return counts;
}

TEST(Rans, SharesSumToAllAndNoneIsLost) {
    const std::vector<uint32_t> counts = uneven_counts();
    const stream::Table table = stream::Table::of_counts(counts);
    uint32_t sum = 0;
    for (uint32_t i = 0; i < counts.size(); ++i) {
        EXPECT_EQ(table.range(i).first, sum);
        EXPECT_EQ(table.range(i).share > 0, counts[i] > 0) << i;
        sum += table.range(i).share;
    }
    EXPECT_EQ(sum, 1u << stream::kTableBits);
    std::vector<uint32_t> many(256, 1);  // most of them must share what little is left
    many[7] = 1'000'000'000;
    EXPECT_EQ(stream::Table::of_counts(many).range(8).share, 1u);
    EXPECT_THROW(stream::Table::of_shares({4096, 1}), std::runtime_error);
    EXPECT_THROW(stream::Table::of_shares({1, 2}), std::runtime_error);
    EXPECT_EQ(stream::Table::of_counts(std::vector<uint32_t>(2)).symbol(4095), 0u);
}

TEST(Rans, SymbolsComeBackInFewBits) {
    const std::vector<uint32_t> counts = uneven_counts();
    const stream::Table table = stream::Table::of_counts(counts);
    Random random(3);
    std::vector<uint32_t> symbols;
    double bits = 0;
    stream::Encoder encoder;
    for (int i = 0; i < 20'000; ++i) {
        symbols.push_back(table.symbol(random.below(1u << stream::kTableBits)));
        encoder.add(table, symbols.back());
        bits += stream::kTableBits - std::log2(table.range(symbols.back()).share);
        if (i % 100 == 0) encoder.add_bits(static_cast<uint32_t>(i / 100 % 256), 8), bits += 8;
    }
    const std::vector<uint8_t> bytes = encoder.finish();
    EXPECT_LT(static_cast<double>(bytes.size()), 1.002 * bits / 8 + 4);
    stream::Decoder decoder(bytes);
    for (int i = 0; i < 20'000; ++i) {
        ASSERT_EQ(decoder.take(table), symbols[static_cast<size_t>(i)]) << i;
        if (i % 100 == 0) {
            ASSERT_EQ(decoder.take_bits(8), static_cast<uint32_t>(i / 100 % 256));
        }
    }
    EXPECT_TRUE(decoder.ends_well());
    stream::Decoder early{std::span<const uint8_t>(bytes).first(bytes.size() / 2)};
    for (int i = 0; i < 20'000; ++i) early.take(table);
    EXPECT_FALSE(early.ends_well());
}

TEST(Rans, TablesComeBack) {
    stream::Counts counts = stream::no_counts();
    Random random(5);
    for (auto& one : counts)
        for (auto& count : one) count = random.below(9) == 0 ? random.below(1000) : 0;
    const stream::Tables tables = stream::tables_of(counts);
    const std::vector<uint8_t> bytes = stream::bytes_of(tables);
    EXPECT_EQ(bytes.size(), stream::table_bytes());
    const stream::Tables read = stream::read_tables(bytes);
    for (size_t i = 0; i < tables.size(); ++i) EXPECT_EQ(read[i].shares(), tables[i].shares()) << i;
    EXPECT_THROW(stream::read_tables(std::span(bytes).first(bytes.size() - 2)), std::runtime_error);
    std::vector<uint8_t> damaged = bytes;
    damaged[1] ^= 1;
    EXPECT_THROW(stream::read_tables(damaged), std::runtime_error);
}

}  // namespace
}  // namespace neuvv::test::rans_test
