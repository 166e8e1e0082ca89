// Range asymmetric numeral systems: symbols as bytes, by tables of how often each is. The stream's page says how the
// bytes are written.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace neuvv::stream {

constexpr uint32_t kTableBits = 12;

// How often each symbol comes, in shares of 2^kTableBits.
class Table {
  public:
    Table() = default;
    // Of the numbers of times that each of at most 256 symbols came; every one that came gets a share. Where none came,
    // symbol 0 has all.
    static Table of_counts(std::span<const uint32_t> counts);
    // Of shares. Throws std::runtime_error where they do not sum to 2^kTableBits.
    static Table of_shares(std::vector<uint16_t> shares);

    const std::vector<uint16_t>& shares() const { return shares_; }
    // A symbol's share, and the sum of those before it.
    struct Range {
        uint16_t first = 0, share = 0;
    };
    Range range(uint32_t symbol) const { return ranges_[symbol]; }
    uint32_t share_of_0() const { return share_of_0_; }
    // The symbol of a value below 2^kTableBits.
    uint32_t symbol(uint32_t value) const {
        uint32_t symbol = first_symbols_[value >> kBucketBits];
        while (value - ranges_[symbol].first >= ranges_[symbol].share) ++symbol;
        return symbol;
    }

  private:
    void finish();
    std::vector<uint16_t> shares_;
    std::array<Range, 256> ranges_{};
    // That of the first of each 16 values. A table of all values is too large for the processor's fastest memory.
    static constexpr uint32_t kBucketBits = 4;
    std::array<uint8_t, 1u << (kTableBits - kBucketBits)> first_symbols_{};
    uint32_t share_of_0_ = 0;
};

// Collects symbols in the order in which they are decoded.
class Encoder {
  public:
    void add(const Table& table, uint32_t symbol) {
        const Table::Range range = table.range(symbol);
        coded_.push_back({range.first, range.share});
    }
    // Bits of equal likelihood, at most 8 of them.
    void add_bits(uint32_t value, uint32_t bits) {
        const uint32_t width = kTableBits - bits;
        coded_.push_back({value << width, 1u << width});
    }
    std::vector<uint8_t> finish() const;

  private:
    struct Coded {
        uint32_t first, share;
    };
    std::vector<Coded> coded_;
};

// Never reads beyond its bytes; where they are damaged or end early, it returns other symbols.
class Decoder {
  public:
    explicit Decoder(std::span<const uint8_t> bytes);
    uint32_t take(const Table& table) {
        const uint32_t value = state_ & ((1u << kTableBits) - 1);
        const uint32_t symbol = table.symbol(value);
        const Table::Range range = table.range(symbol);
        advance(range.first, range.share, value);
        return symbol;
    }
    // Of a table of two symbols, without looking it up.
    uint32_t take_either(const Table& table) {
        const uint32_t value = state_ & ((1u << kTableBits) - 1), share = table.share_of_0();
        const bool second = value >= share;
        advance(second ? share : 0, second ? (1u << kTableBits) - share : share, value);
        return second ? 1 : 0;
    }
    uint32_t take_bits(uint32_t bits) {
        const uint32_t width = kTableBits - bits, value = state_ & ((1u << kTableBits) - 1);
        advance(value >> width << width, 1u << width, value);
        return value >> width;
    }
    // Whether exactly the bytes were needed for what was taken, as it must be at the end.
    bool ends_well() const { return next_ == bytes_.size() && state_ == kFirstState; }
    // Whether the last symbol, or an earlier one, needed more bytes than there are: those behind it are not known.
    bool is_over() const { return next_ > bytes_.size(); }
    static constexpr uint32_t kFirstState = 1u << 16;

  private:
    void advance(uint32_t first, uint32_t share, uint32_t value) {
        state_ = share * (state_ >> kTableBits) + value - first;
        if (state_ >= kFirstState) return;
        uint32_t word = 0;
        if (next_ + 2 <= bytes_.size()) word = bytes_[next_] | bytes_[next_ + 1] << 8;
        next_ += 2;
        state_ = state_ << 16 | word;
    }
    std::span<const uint8_t> bytes_;
    size_t next_ = 0;
    uint32_t state_ = kFirstState;
};

}  // namespace neuvv::stream
