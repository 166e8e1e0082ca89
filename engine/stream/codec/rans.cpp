#include "stream/codec/rans.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace neuvv::stream {

namespace {

constexpr uint32_t kAll = 1u << kTableBits;

// Takes from the largest share, or gives to it, until they sum to kAll.
void balance(std::vector<uint16_t>& shares) {
    int64_t missing = int64_t{kAll} - std::accumulate(shares.begin(), shares.end(), int64_t{0});
    while (missing != 0) {
        uint16_t& largest = *std::max_element(shares.begin(), shares.end());
        const int64_t step = std::clamp<int64_t>(missing, -(largest - 1) / 2 - 1, missing > 0 ? missing : 0);
        largest = static_cast<uint16_t>(largest + step);
        missing -= step;
    }
}

}  // namespace

Table Table::of_counts(std::span<const uint32_t> counts) {
    const uint64_t sum = std::accumulate(counts.begin(), counts.end(), uint64_t{0});
    std::vector<uint16_t> shares(counts.size());
    if (sum == 0) shares[0] = kAll;
    for (size_t i = 0; i < counts.size(); ++i)
        if (counts[i] > 0)
            shares[i] = static_cast<uint16_t>(std::max<uint64_t>((uint64_t{counts[i]} * kAll + sum / 2) / sum, 1));
    if (sum > 0) balance(shares);
    return of_shares(std::move(shares));
}

Table Table::of_shares(std::vector<uint16_t> shares) {
    Table table;
    if (std::accumulate(shares.begin(), shares.end(), uint64_t{0}) != kAll)
        throw std::runtime_error("has a table of shares that do not add up");
    table.shares_ = std::move(shares);
    table.finish();
    return table;
}

void Table::finish() {
    share_of_0_ = shares_[0];
    uint32_t next = 0;
    for (size_t i = 0; i < shares_.size(); ++i) {
        ranges_[i] = {static_cast<uint16_t>(next), shares_[i]};
        next += shares_[i];
    }
    uint32_t symbol = 0;
    for (uint32_t bucket = 0; bucket < first_symbols_.size(); ++bucket) {
        const uint32_t value = bucket << kBucketBits;
        while (value - ranges_[symbol].first >= ranges_[symbol].share) ++symbol;
        first_symbols_[bucket] = static_cast<uint8_t>(symbol);
    }
}

// The last symbol is encoded first, so that the decoder meets them in their order.
std::vector<uint8_t> Encoder::finish() const {
    std::vector<uint16_t> words;
    uint32_t state = Decoder::kFirstState;
    for (auto one = coded_.rbegin(); one != coded_.rend(); ++one) {
        if (state >= uint64_t{one->share} << (32 - kTableBits)) {
            words.push_back(static_cast<uint16_t>(state));
            state >>= 16;
        }
        state = (state / one->share << kTableBits) + state % one->share + one->first;
    }
    words.push_back(static_cast<uint16_t>(state));
    words.push_back(static_cast<uint16_t>(state >> 16));
    std::vector<uint8_t> bytes;
    bytes.reserve(2 * words.size());
    for (auto word = words.rbegin(); word != words.rend(); ++word) {
        bytes.push_back(static_cast<uint8_t>(*word));
        bytes.push_back(static_cast<uint8_t>(*word >> 8));
    }
    return bytes;
}

// The first word is the high half of the state.
Decoder::Decoder(std::span<const uint8_t> bytes) : bytes_(bytes) {
    if (bytes.size() < 4) return;
    state_ = static_cast<uint32_t>(bytes[0] << 16 | bytes[1] << 24 | bytes[2] | bytes[3] << 8);
    next_ = 4;
}

}  // namespace neuvv::stream
