// A file on a server, read by ranges (RFC 9110, section 14). Any plain file server does.
#pragma once

#include <atomic>
#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "stream/transport/block_cache.h"
#include "stream/transport/byte_source.h"
#include "stream/transport/transfer_watch.h"

namespace neuvv::stream {

// A thread fetches blocks: those that somebody waits for, else those that are read next. They are kept in memory, up to
// a limit, and on the disk (block_cache.h); only the first block always comes from the server. TLS certificates are
// verified; redirects are followed, but not from https to http, and not from other networks into the user's own. Where
// a server is busy or the connection breaks, the request is repeated some times, as long as a block may take.
class HttpSource : public ByteSource {
  public:
    static constexpr double kMost_sABlock = 30;
    // Reads the first block, so as to learn the size. Throws InputError as read() does.
    explicit HttpSource(std::string address, CachePlace cache = usual_cache(), double most_s_a_block = kMost_sABlock);
    ~HttpSource() override;
    HttpSource(const HttpSource&) = delete;
    HttpSource& operator=(const HttpSource&) = delete;

    // Throws InputError where the server does not answer, not with this range, or with that of another file.
    std::vector<uint8_t> read(uint64_t offset, uint64_t count) override;
    void read_ahead(const std::vector<ByteRange>& ranges) override;
    std::optional<double> bytes_per_s() const override;
    void forget_copies() override;
    void cancel() override;

    static constexpr uint64_t kBlock = uint64_t{64} << 10;
    static constexpr uint64_t kMostBlocks = 1024;    // 64 MiB
    static constexpr uint64_t kMostOfARequest = 16;  // blocks
    // Of what is read ahead, a block or more: as many as come in so many seconds, or in four times what the server
    // needs to answer, so that most of the time bytes come. Who waits for others must wait for these first.
    static constexpr double kRequestAhead_s = 0.1;
    static constexpr uint64_t kMostAhead = kMostBlocks / 2;

  private:
    struct Answer;
    struct Blocks {
        uint64_t first = 0, end = 0;
        uint64_t count() const { return end - first; }
    };
    std::vector<uint8_t> fetch(const Blocks& blocks);
    std::optional<std::vector<uint8_t>> read_copy(uint64_t block) const;
    void keep_copies(uint64_t first, const std::vector<uint8_t>& bytes);
    Answer request(uint64_t offset, uint64_t count);
    void require_range(const Answer& answer, uint64_t offset, uint64_t count);
    void run();
    // What a call of read() waits for, and why it is in vain.
    struct Need {
        Blocks blocks;
        std::exception_ptr failure{};
    };
    Blocks missing_locked(const Blocks& in, uint64_t most = kMostOfARequest) const;
    Blocks missing_needed_locked() const;
    Blocks missing_ahead_locked() const;
    void measure_locked(uint64_t bytes, double seconds);
    void measure_line(const Answer& answer);
    uint64_t most_ahead_locked() const;
    void keep_locked(uint64_t first, const std::vector<uint8_t>& bytes);
    void use_locked(uint64_t block);
    std::string address_;
    double most_s_a_block_;
    void* curl_ = nullptr;  // CURL: the constructor's, then the thread's
    std::atomic<bool> cancelled_ = false;
    std::optional<BlockCache> cache_;  // since the first block is here
    std::mutex copies_mutex_;          // guards writing to it and forgetting
    bool keeps_copies_ = true;         // until they are forgotten
    mutable std::mutex mutex_;         // guards all that follows
    std::condition_variable changed_;
    std::map<uint64_t, std::vector<uint8_t>> blocks_;
    std::vector<uint64_t> order_;  // of the blocks, the one that was used last at the end
    std::vector<Need*> needs_;     // of the calls of read(), the first first
    std::vector<Blocks> ahead_;    // what will be read next
    // Of the last requests, of which older ones count less. Bytes and seconds, also of copies from the disk:
    double recent_bytes_ = 0, recent_s_ = 0;
    // Of those that the server answered: bytes, seconds from the first byte on, and seconds until the first byte.
    double line_bytes_ = 0, line_s_ = 0, answer_s_ = 0;
    bool stop_ = false;
    std::thread thread_;
};

}  // namespace neuvv::stream
