// A file on a server, read by ranges (RFC 9110, section 14). Any plain file server does.
#pragma once

#include <atomic>
#include <map>
#include <string>

#include "stream/byte_source.h"

namespace neuvv::stream {

// What was read is kept in memory in blocks, up to a limit. TLS certificates are verified; redirects are followed, but
// not from https to http. Where a server is busy or the connection breaks, the request is repeated some times.
class HttpSource : public ByteSource {
  public:
    // Reads the first block, so as to learn the size. Throws InputError as read() does.
    explicit HttpSource(std::string address);
    ~HttpSource() override;
    HttpSource(const HttpSource&) = delete;
    HttpSource& operator=(const HttpSource&) = delete;

    // Throws InputError where the server does not answer, not with this range, or with that of another file.
    std::vector<uint8_t> read(uint64_t offset, uint64_t count) override;
    void cancel() override { cancelled_ = true; }

    static constexpr uint64_t kBlock = uint64_t{256} << 10;
    static constexpr size_t kMostBlocks = 256;  // 64 MiB

  private:
    struct Answer;
    void fetch(uint64_t first_block, uint64_t blocks);
    Answer request(uint64_t offset, uint64_t count);
    void require_range(const Answer& answer, uint64_t offset, uint64_t count);
    std::string address_;
    void* curl_ = nullptr;  // CURL
    std::atomic<bool> cancelled_ = false;
    std::map<uint64_t, std::vector<uint8_t>> blocks_;
    std::vector<uint64_t> order_;  // of the blocks, the one that was used last at the end
};

}  // namespace neuvv::stream
