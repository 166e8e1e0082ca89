// The content of a file in memory, as libav reads it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <new>
#include <span>

#include "media/libav.h"

namespace neuvv::media {

// It and the bytes must outlive what reads them.
class MemoryInput {
  public:
    explicit MemoryInput(std::span<const uint8_t> bytes) : bytes_(bytes) {
        auto* buffer = static_cast<uint8_t*>(av_malloc(kBuffer));
        if (buffer) context_ = avio_alloc_context(buffer, kBuffer, 0, this, &read, nullptr, &seek);
        if (!context_) {
            av_free(buffer);
            throw std::bad_alloc();
        }
    }
    ~MemoryInput() {
        av_freep(&context_->buffer);
        avio_context_free(&context_);
    }
    MemoryInput(const MemoryInput&) = delete;
    MemoryInput& operator=(const MemoryInput&) = delete;

    AVIOContext* context() const { return context_; }

  private:
    static constexpr int kBuffer = 1 << 16;

    static int read(void* self, uint8_t* to, int count) {
        auto& input = *static_cast<MemoryInput*>(self);
        const size_t left = input.bytes_.size() - input.at_;
        if (left == 0) return AVERROR_EOF;
        const size_t taken = std::min(left, static_cast<size_t>(count));
        std::memcpy(to, input.bytes_.data() + input.at_, taken);
        input.at_ += taken;
        return static_cast<int>(taken);
    }
    static int64_t seek(void* self, int64_t offset, int whence) {
        auto& input = *static_cast<MemoryInput*>(self);
        const auto size = static_cast<int64_t>(input.bytes_.size());
        const int from = whence & ~AVSEEK_FORCE;
        if (from == AVSEEK_SIZE) return size;
        if (from != SEEK_SET && from != SEEK_CUR && from != SEEK_END) return AVERROR(EINVAL);
        const int64_t base = from == SEEK_CUR ? static_cast<int64_t>(input.at_) : from == SEEK_END ? size : 0;
        if (offset < -base || offset > size - base) return AVERROR(EINVAL);
        input.at_ = static_cast<size_t>(base + offset);
        return base + offset;
    }

    std::span<const uint8_t> bytes_;
    size_t at_ = 0;  // the next byte, at most their number
    AVIOContext* context_ = nullptr;
};

}  // namespace neuvv::media
