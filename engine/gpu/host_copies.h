// Copies between host and device, most through staging buffers, which wait: for set-up, for threads beside the one that
// draws, and for tests. Uploads run on the transfer queue where the device has one.
#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

#include "gpu/buffer.h"

namespace neuvv::gpu {

class Commands;

// Uploads of several buffers, submitted together: without a transfer queue, each submission waits until the device is
// done with what it draws. No submission that uses the buffers may be under way.
class Uploads {
  public:
    explicit Uploads(const Device& device) : device_(device) {}
    // The data must exist until finish(). Throws RuntimeFailure where the buffer has fewer bytes.
    void add(const Buffer& to, const void* data, uint64_t bytes);
    // Creates a buffer on the device that will hold the values, read through texels of the format.
    template <typename T>
    Buffer add(const char* name, const std::vector<T>& values, VkFormat format) {
        Buffer buffer(device_, name, values.size() * sizeof(T), MemoryKind::kDevice, format);
        add(buffer, values.data(), values.size() * sizeof(T));
        return buffer;
    }
    // Creates a buffer on the device whose bytes are those that `write` writes, before this returns, in any order and
    // without reading any; others are undefined. Where the host sees the device's memory, they are written there.
    Buffer add_written(const char* name, uint64_t bytes, VkFormat format, const std::function<void(void*)>& write);
    // The same of values, which need not exist until finish().
    template <typename T>
    Buffer add_copied(const char* name, const std::vector<T>& values, VkFormat format) {
        return add_written(name, values.size() * sizeof(T), format,
                           [&](void* to) { std::copy(values.begin(), values.end(), static_cast<T*>(to)); });
    }
    // Copies through a staging buffer, which is filled again where it is too small for all, and waits.
    void finish();

  private:
    struct Copy {
        VkBuffer to;
        const char* data;
        uint64_t bytes;
    };
    // The copy that is not finished yet, and how many of its bytes are copied.
    struct Progress {
        size_t copy = 0;
        uint64_t bytes = 0;
    };
    void record_staged(Commands& commands, const Buffer& staging, Progress& progress) const;
    const Device& device_;
    std::vector<Copy> copies_;
    std::vector<std::unique_ptr<char[]>> written_;  // what is to be copied of add_written
    uint64_t bytes_ = 0;
};

constexpr uint64_t kStagedPiece = uint64_t{64} << 20;  // bytes of a staging buffer at most
// Copy between host and device, through a staging buffer, piece by piece, and wait. They throw RuntimeFailure where the
// buffer has fewer than `bytes` bytes. No submission that uses the buffer may be under way.
void upload(const Device& device, const Buffer& to, const void* data, uint64_t bytes);
void download(const Device& device, const Buffer& from, void* data, uint64_t bytes);
// The same, for what need not be kept as it is: calls `take` with each piece, which begins at byte `at` of the buffer.
// All but the last have kStagedPiece bytes.
using DownloadedPiece = std::function<void(const void* piece, uint64_t at, uint64_t bytes)>;
void download_pieces(const Device& device, const Buffer& from, uint64_t bytes, const DownloadedPiece& take);

// A new buffer on the device that holds the values, read through texels of the format.
template <typename T>
Buffer uploaded(const Device& device, const char* name, const std::vector<T>& values, VkFormat format) {
    Buffer buffer(device, name, values.size() * sizeof(T), MemoryKind::kDevice, format);
    if (!values.empty()) upload(device, buffer, values.data(), values.size() * sizeof(T));
    return buffer;
}

}  // namespace neuvv::gpu
