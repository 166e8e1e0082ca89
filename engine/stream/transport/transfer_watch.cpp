#include "stream/transport/transfer_watch.h"

#include <fmt/format.h>

#include <mutex>
#include <utility>

#include "base/seconds.h"

namespace neuvv::stream {

namespace {

constexpr double kFirstWords_s = 3, kWordsEvery_s = 10;

std::mutex g_sink_mutex;
std::function<void(const std::string&)> g_sink;  // guarded by it

}  // namespace

void RedirectRule::redirected_by(const char* ip) {
    if (!limit_) limit_ = nearness_of(ip).value_or(Nearness::kPublic);
}

bool RedirectRule::allows(const sockaddr& address) {
    const bool allowed = !limit_ || nearness_of(address) <= *limit_;
    has_refused_ = has_refused_ || !allowed;
    return allowed;
}

TransferWatch::TransferWatch(std::string server, uint64_t block_bytes, double most_s_a_block)
    : server_(std::move(server)),
      block_bytes_(block_bytes),
      most_s_a_block_(most_s_a_block),
      began_s_(seconds_now()),
      block_began_s_(began_s_),
      next_words_s_(began_s_ + kFirstWords_s) {}

bool TransferWatch::may_go_on(uint64_t bytes) {
    const double now_s = seconds_now();
    if (bytes / block_bytes_ > blocks_) {
        blocks_ = bytes / block_bytes_;
        block_began_s_ = now_s;
    }
    if (now_s >= next_words_s_) {
        next_words_s_ = now_s + kWordsEvery_s;
        const std::lock_guard lock(g_sink_mutex);
        if (g_sink)
            g_sink(fmt::format("waits for {}: {:.1f} kB came in {:.0f} s", server_, static_cast<double>(bytes) / 1000,
                               now_s - began_s_));
    }
    too_slow_ = now_s - block_began_s_ > most_s_a_block_;
    return !too_slow_;
}

void set_waiting_sink(std::function<void(const std::string&)> sink) {
    const std::lock_guard lock(g_sink_mutex);
    g_sink = std::move(sink);
}

}  // namespace neuvv::stream
