#include "stream/codec/symbols.h"

#include <stdexcept>

namespace neuvv::stream {

Counts no_counts() {
    Counts counts(kTables);
    for (uint32_t table = 0; table < kTables; ++table) counts[table].resize(symbols_of(table));
    return counts;
}

Tables tables_of(const Counts& counts) {
    Tables tables;
    for (const std::vector<uint32_t>& one : counts) tables.push_back(Table::of_counts(one));
    return tables;
}

std::vector<uint8_t> bytes_of(const Tables& tables) {
    std::vector<uint8_t> bytes;
    for (const Table& table : tables)
        for (const uint16_t share : table.shares()) {
            bytes.push_back(static_cast<uint8_t>(share));
            bytes.push_back(static_cast<uint8_t>(share >> 8));
        }
    return bytes;
}

size_t table_bytes() {
    size_t bytes = 0;
    for (uint32_t table = 0; table < kTables; ++table) bytes += 2 * symbols_of(table);
    return bytes;
}

Tables read_tables(std::span<const uint8_t> bytes) {
    Tables tables;
    size_t next = 0;
    for (uint32_t table = 0; table < kTables; ++table) {
        std::vector<uint16_t> shares(symbols_of(table));
        if (bytes.size() < next + 2 * shares.size()) throw std::runtime_error("has tables that end early");
        for (uint16_t& share : shares) {
            share = static_cast<uint16_t>(bytes[next] | bytes[next + 1] << 8);
            next += 2;
        }
        tables.push_back(Table::of_shares(std::move(shares)));
    }
    if (next != bytes.size()) throw std::runtime_error("has bytes behind its tables");
    return tables;
}

void SymbolWriter::count(Counts& counts) const {
    for (const uint32_t one : symbols_)
        if (!(one & kBits)) ++counts[one >> 8][one & 0xff];
}

std::vector<uint8_t> SymbolWriter::bytes(const Tables& tables) const {
    if (symbols_.empty()) return {};
    Encoder encoder;
    for (const uint32_t one : symbols_)
        if (one & kBits)
            encoder.add_bits(one & 0xff, one >> 8 & 0xff);
        else
            encoder.add(tables[one >> 8], one & 0xff);
    return encoder.finish();
}

}  // namespace neuvv::stream
