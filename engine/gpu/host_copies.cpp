#include "gpu/host_copies.h"

#include <algorithm>
#include <cstring>

#include "base/error.h"
#include "gpu/commands.h"

namespace neuvv::gpu {

void Uploads::add(const Buffer& to, const void* data, uint64_t bytes) {
    if (bytes > to.bytes) throw RuntimeFailure("upload: more bytes than buffer \"" + to.name + "\" holds");
    if (bytes == 0) return;
    copies_.push_back({to.buffer, static_cast<const char*>(data), bytes});
    bytes_ += bytes;
}

void Uploads::finish() {
    if (bytes_ == 0) return;
    const Buffer staging(device_, "staging", std::min(bytes_, kStagedPiece), MemoryKind::kUpload);
    size_t next = 0;  // the copy that is not finished yet, and how many of its bytes are copied
    uint64_t done = 0;
    while (next < copies_.size())
        run_once(device_, "upload", [&](Commands& commands) {
            for (uint64_t used = 0; next < copies_.size() && used < staging.bytes;) {
                const Copy& one = copies_[next];
                const uint64_t piece = std::min(one.bytes - done, staging.bytes - used);
                std::memcpy(staging.as<char>() + used, one.data + done, piece);
                const VkBufferCopy region{used, done, piece};
                vkCmdCopyBuffer(commands.handle(), staging.buffer, one.to, 1, &region);
                used += piece;
                done += piece;
                if (done < one.bytes) continue;
                done = 0;
                next++;
            }
            compute_barrier(commands);
        });
    copies_.clear();
    bytes_ = 0;
}

void upload(const Device& device, const Buffer& to, const void* data, uint64_t bytes) {
    Uploads uploads(device);
    uploads.add(to, data, bytes);
    uploads.finish();
}

void download_pieces(const Device& device, const Buffer& from, uint64_t bytes, const DownloadedPiece& take) {
    if (bytes > from.bytes) throw RuntimeFailure("download: more bytes than buffer \"" + from.name + "\" holds");
    if (bytes == 0) return;
    const Buffer staging(device, "staging", std::min(bytes, kStagedPiece), MemoryKind::kReadback);
    for (uint64_t at = 0; at < bytes; at += kStagedPiece) {
        const uint64_t piece = std::min(kStagedPiece, bytes - at);
        run_once(device, "download", [&](Commands& commands) {
            copy(commands, from, staging, piece, at, 0);
            host_barrier(commands);
        });
        take(staging.mapped, at, piece);
    }
}

void download(const Device& device, const Buffer& from, void* data, uint64_t bytes) {
    download_pieces(device, from, bytes, [&](const void* piece, uint64_t at, uint64_t piece_bytes) {
        std::memcpy(static_cast<char*>(data) + at, piece, piece_bytes);
    });
}

}  // namespace neuvv::gpu
