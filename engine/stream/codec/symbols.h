// Symbols of a stream before they are bytes, by the tables of a group: how often each comes is known only when all
// frames of the group are encoded.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "stream/codec/rans.h"

namespace neuvv::stream {

// Tables by context, as the stream's page has them. Their numbers, and how many symbols each has:
constexpr uint32_t kOctantTables = 0, kOctantContexts = 2 * 64;                           // 256 symbols
constexpr uint32_t kLeafTables = kOctantTables + kOctantContexts, kLeafContexts = 2 * 4;  // 2 symbols
constexpr uint32_t kRepeatTables = kLeafTables + kLeafContexts, kRepeatContexts = 2;      // 2 symbols
constexpr uint32_t kKinds = 6, kDepthClasses = 3, kActivities = 6;
constexpr uint32_t kPlaneContexts = kKinds * kDepthClasses * kActivities;
constexpr uint32_t kAnyTables = kRepeatTables + kRepeatContexts;  // 2 symbols
constexpr uint32_t kNumberTables = kAnyTables + kPlaneContexts;   // kNumbers symbols
constexpr uint32_t kTables = kNumberTables + kPlaneContexts;
constexpr uint32_t kNumbers = 16;  // the last is an escape

constexpr uint32_t symbols_of(uint32_t table) {
    return table < kLeafTables ? 256 : table < kNumberTables ? 2 : kNumbers;
}

using Tables = std::vector<Table>;  // kTables
using Counts = std::vector<std::vector<uint32_t>>;
Counts no_counts();
Tables tables_of(const Counts& counts);
// All shares as 16 bits, table by table.
std::vector<uint8_t> bytes_of(const Tables& tables);
size_t table_bytes();  // their number
// Throws std::runtime_error where the bytes are no tables.
Tables read_tables(std::span<const uint8_t> bytes);

// The symbols of one stream in order. It has the interface of SymbolReader, so that one function can write and read.
class SymbolWriter {
  public:
    static constexpr bool kWrites = true;
    uint32_t take(uint32_t table, uint32_t symbol) {
        symbols_.push_back(table << 8 | symbol);
        return symbol;
    }
    uint32_t take_either(uint32_t table, uint32_t symbol) { return take(table, symbol); }
    uint32_t take_bits(uint32_t bits, uint32_t value) {
        symbols_.push_back(kBits | bits << 8 | value);
        return value;
    }
    bool is_over() const { return false; }
    void count(Counts& counts) const;
    std::vector<uint8_t> bytes(const Tables& tables) const;

  private:
    static constexpr uint32_t kBits = 1u << 31;
    std::vector<uint32_t> symbols_;
};

// Its functions ignore their last argument, which a writer writes.
class SymbolReader {
  public:
    static constexpr bool kWrites = false;
    SymbolReader(std::span<const uint8_t> bytes, const Tables& tables) : decoder_(bytes), tables_(tables.data()) {}
    uint32_t take(uint32_t table, uint32_t) { return decoder_.take(tables_[table]); }
    uint32_t take_either(uint32_t table, uint32_t) { return decoder_.take_either(tables_[table]); }
    uint32_t take_bits(uint32_t bits, uint32_t) { return decoder_.take_bits(bits); }
    bool ends_well() const { return decoder_.ends_well(); }
    bool is_over() const { return decoder_.is_over(); }

  private:
    Decoder decoder_;
    const Table* tables_;
};

}  // namespace neuvv::stream
