// What a request to a server may do: how long a block may take, and where redirects may lead.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "base/nearness.h"

namespace neuvv::stream {

// Redirects may not lead nearer to this machine than the address does that was asked: else a stage of somebody else, or
// the server that it names, could make this program ask the router, or a service that trusts this machine. An object is
// of one request: until the server redirects, all addresses that its name has may be tried.
class RedirectRule {
  public:
    // The server at this IP address has answered with a redirect. Only the first of them sets the limit.
    void redirected_by(const char* ip);
    bool allows(const sockaddr& address);
    bool has_refused() const { return has_refused_; }

  private:
    std::optional<Nearness> limit_;
    bool has_refused_ = false;
};

// Called about once a second for each request that is being answered.
class TransferWatch {
  public:
    // `server`: how it is named in words.
    TransferWatch(std::string server, uint64_t block_bytes, double most_s_a_block);
    // Whether the request may go on, of which so many bytes have come. Says after some seconds, and then again and
    // again, that it waits (set_waiting_sink).
    bool may_go_on(uint64_t bytes);
    bool was_too_slow() const { return too_slow_; }

  private:
    std::string server_;
    uint64_t block_bytes_, blocks_ = 0;
    double most_s_a_block_, began_s_, block_began_s_, next_words_s_;
    bool too_slow_ = false;
};

// Who is told that a server is waited for, from any thread; nobody is, unless it is set.
void set_waiting_sink(std::function<void(const std::string& line)> sink);

}  // namespace neuvv::stream
