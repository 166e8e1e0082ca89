// Numbers as bytes, the lowest first.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <vector>

namespace neuvv::stream {

inline void append_number(std::vector<uint8_t>& bytes, uint64_t number, int count) {
    for (int i = 0; i < count; ++i) bytes.push_back(static_cast<uint8_t>(number >> 8 * i));
}

// Reads numbers one after the other. Throws std::runtime_error where there are not enough bytes.
class ByteReader {
  public:
    explicit ByteReader(std::span<const uint8_t> bytes) : rest_(bytes) {}
    uint64_t number(uint32_t count) {
        const std::span<const uint8_t> bytes = take(count);
        uint64_t value = 0;
        for (uint32_t i = 0; i < count; ++i) value |= uint64_t{bytes[i]} << 8 * i;
        return value;
    }
    std::span<const uint8_t> take(uint64_t count) {
        if (count > rest_.size()) throw std::runtime_error("ends early");
        const std::span<const uint8_t> taken = rest_.first(count);
        rest_ = rest_.subspan(count);
        return taken;
    }

    // Throws std::runtime_error where bytes are left.
    void expect_end() const {
        if (!rest_.empty()) throw std::runtime_error("has more bytes than it needs");
    }

  private:
    std::span<const uint8_t> rest_;
};

}  // namespace neuvv::stream
