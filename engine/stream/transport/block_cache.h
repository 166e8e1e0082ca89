// Blocks of a stream from a server, kept on the disk, so that a show that was played once comes from there the next
// time. All streams together take little more than a limit; what was not used for longest goes first.
#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace neuvv::stream {

// Where blocks are kept unless somebody says something else, and how many bytes of them: 1 GiB, or as many MiB as
// NEUVV_STREAM_CACHE of the environment says. An empty folder or 0 bytes: none are kept. usual_cache() throws
// InputError where that is no number.
struct CachePlace {
    std::filesystem::path folder;
    uint64_t limit_bytes = 0;
};
CachePlace usual_cache();

// The blocks of one stream. Any thread may call its functions. A disk that is full or broken only means that less is
// kept: no function throws for it. Several programs may use the same folder.
class BlockCache {
  public:
    // `beginning` are the stream's first bytes, which tell it from an older one at the same address and of the same
    // size.
    BlockCache(CachePlace place, const std::string& address, uint64_t size, std::span<const uint8_t> beginning);

    // The block, where it is kept, whole and of so many bytes.
    std::optional<std::vector<uint8_t>> read(uint64_t block, uint64_t bytes) const;
    void write(uint64_t block, std::span<const uint8_t> bytes);
    // Removes all blocks of this stream.
    void forget();

  private:
    std::filesystem::path file_of(uint64_t block) const;
    void trim() const;
    CachePlace place_;
    std::filesystem::path folder_;     // of this stream; empty: nothing is kept
    std::mutex mutex_;                 // guards what follows
    std::optional<uint64_t> written_;  // bytes since all streams' were counted; nothing: they never were
};

}  // namespace neuvv::stream
