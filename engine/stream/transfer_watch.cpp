#include "stream/transfer_watch.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netinet/in.h>

#include <cstring>
#include <mutex>
#include <utility>

#include "base/seconds.h"

namespace neuvv::stream {

namespace {

constexpr double kFirstWords_s = 3, kWordsEvery_s = 10;

// The networks that are not everybody's (RFC 6890), by their first bits. What is bound to a link counts as this
// machine: there, services of clouds hand out passwords. So do addresses of no single machine.
struct Network {
    uint32_t address;
    int bits;
    Nearness nearness;
};
constexpr Network kNetworks[] = {
    {0x00000000, 8, Nearness::kOwnMachine},   // this machine
    {0x7f000000, 8, Nearness::kOwnMachine},   // loopback
    {0xa9fe0000, 16, Nearness::kOwnMachine},  // bound to a link
    {0xe0000000, 3, Nearness::kOwnMachine},   // groups, reserved, all machines
    {0x0a000000, 8, Nearness::kOwnNetwork},  {0xac100000, 12, Nearness::kOwnNetwork},
    {0xc0a80000, 16, Nearness::kOwnNetwork}, {0x64400000, 10, Nearness::kOwnNetwork},  // of a provider
    {0xc0000000, 24, Nearness::kOwnNetwork}, {0xc6120000, 15, Nearness::kOwnNetwork},  // for measurements
};

Nearness nearness_of_v4(uint32_t address) {
    for (const Network& network : kNetworks)
        if ((address ^ network.address) >> (32 - network.bits) == 0) return network.nearness;
    return Nearness::kPublic;
}

uint32_t number_at(const uint8_t* bytes) {
    return uint32_t{bytes[0]} << 24 | uint32_t{bytes[1]} << 16 | uint32_t{bytes[2]} << 8 | bytes[3];
}

Nearness nearness_of_v6(const in6_addr& address) {
    const uint8_t* bytes = address.s6_addr;
    constexpr uint8_t kZeros[15] = {}, kTranslated[12] = {0x00, 0x64, 0xff, 0x9b};
    if (IN6_IS_ADDR_V4MAPPED(&address) || std::memcmp(bytes, kTranslated, sizeof kTranslated) == 0)
        return nearness_of_v4(number_at(bytes + 12));
    if (bytes[0] == 0x20 && bytes[1] == 0x02) return nearness_of_v4(number_at(bytes + 2));  // 6to4
    if (std::memcmp(bytes, kZeros, sizeof kZeros) == 0) return Nearness::kOwnMachine;       // ::, ::1
    if ((bytes[0] == 0xfe && (bytes[1] & 0xc0) == 0x80) || bytes[0] == 0xff) return Nearness::kOwnMachine;
    const bool local = (bytes[0] & 0xfe) == 0xfc || (bytes[0] == 0xfe && (bytes[1] & 0xc0) == 0xc0);
    return local ? Nearness::kOwnNetwork : Nearness::kPublic;
}

std::mutex g_sink_mutex;
std::function<void(const std::string&)> g_sink;  // guarded by it

}  // namespace

Nearness nearness_of(const sockaddr& address) {
    if (address.sa_family == AF_INET)
        return nearness_of_v4(ntohl(reinterpret_cast<const sockaddr_in&>(address).sin_addr.s_addr));
    if (address.sa_family == AF_INET6) return nearness_of_v6(reinterpret_cast<const sockaddr_in6&>(address).sin6_addr);
    return Nearness::kOwnMachine;
}

void RedirectRule::redirected_by(const char* ip) {
    if (limit_) return;
    in_addr v4 = {};
    in6_addr v6 = {};
    limit_ = Nearness::kPublic;
    if (inet_pton(AF_INET, ip, &v4) == 1)
        limit_ = nearness_of_v4(ntohl(v4.s_addr));
    else if (inet_pton(AF_INET6, ip, &v6) == 1)
        limit_ = nearness_of_v6(v6);
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
