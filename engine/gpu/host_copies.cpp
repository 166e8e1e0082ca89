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

Buffer Uploads::add_written(const char* name, uint64_t bytes, VkFormat format,
                            const std::function<void(void*)>& write) {
    Buffer buffer(device_, name, bytes, MemoryKind::kShared, format);
    if (buffer.mapped) {
        write(buffer.mapped);
        return buffer;
    }
    written_.push_back(std::make_unique_for_overwrite<char[]>(bytes));
    write(written_.back().get());
    add(buffer, written_.back().get(), bytes);
    return buffer;
}

void Uploads::finish() {
    if (bytes_ == 0) return;
    const uint64_t most = std::min(kStagedPiece, device_.max_allocation_bytes());
    const Buffer staging(device_, "staging", std::min(bytes_, most), MemoryKind::kUpload);
    Commands commands(device_, "upload", 1, QueueKind::kTransfer);
    Progress progress;
    while (progress.copy < copies_.size()) {
        commands.begin();
        record_staged(commands, staging, progress);
        commands.submit();
        commands.wait();
    }
    copies_.clear();
    written_.clear();
    bytes_ = 0;
}

// Fills the staging buffer from where the last submission ended, and records the copies out of it.
void Uploads::record_staged(Commands& commands, const Buffer& staging, Progress& progress) const {
    for (uint64_t used = 0; progress.copy < copies_.size() && used < staging.bytes;) {
        const Copy& one = copies_[progress.copy];
        const uint64_t piece = std::min(one.bytes - progress.bytes, staging.bytes - used);
        std::memcpy(staging.as<char>() + used, one.data + progress.bytes, piece);
        const VkBufferCopy region{used, progress.bytes, piece};
        vkCmdCopyBuffer(commands.handle(), staging.buffer, one.to, 1, &region);
        used += piece;
        progress.bytes += piece;
        if (progress.bytes == one.bytes) progress = {progress.copy + 1, 0};
    }
    // With a transfer queue, the main queue waits for its semaphore.
    if (!device_.transfer_queue()) compute_barrier(commands);
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
