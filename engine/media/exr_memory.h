// What the writers of OpenEXR files share: they encode in memory, and write the bytes atomically.
#pragma once

#include <ImfIO.h>
#include <fmt/format.h>
#include <half.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <vector>

#include "base/error.h"
#include "base/platform.h"

namespace neuvv::media {

// A stream in memory for the library.
class MemoryOut : public Imf::OStream {
  public:
    MemoryOut() : Imf::OStream("memory") {}
    void write(const char* data, int count) override {
        const auto size = static_cast<size_t>(count);
        if (at_ + size > bytes.size()) bytes.resize(at_ + size);
        std::memcpy(bytes.data() + at_, data, size);
        at_ += size;
    }
    uint64_t tellp() override { return at_; }
    void seekp(uint64_t position) override { at_ = position; }

    std::vector<char> bytes;

  private:
    size_t at_ = 0;
};

inline half half_of(float value) {
    constexpr float kMaxHalf = 65504;
    return half(std::clamp(value, -kMaxHalf, kMaxHalf));
}

// The bytes that `write` writes by a file object of the library, whose destructor completes the file.
template <typename Write>
std::vector<char> encoded(const Write& write) {
    MemoryOut out;
    write(out);
    return std::move(out.bytes);
}

// Writes the bytes that `encode` returns. Throws RuntimeFailure.
template <typename Encode>
void write_encoded(const std::filesystem::path& file, const Encode& encode) {
    std::vector<char> bytes;
    try {
        bytes = encode();
    } catch (const std::exception& error) {
        throw RuntimeFailure(fmt::format("{}: cannot encode an EXR: {}", file.string(), error.what()));
    }
    write_file_atomically(file, [&](const ByteSink& sink) { sink(bytes.data(), bytes.size()); });
}

}  // namespace neuvv::media
