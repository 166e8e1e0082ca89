#include "base/nearness.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cstdint>
#include <cstring>

namespace neuvv {

namespace {

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

}  // namespace

Nearness nearness_of(const sockaddr& address) {
    if (address.sa_family == AF_INET)
        return nearness_of_v4(ntohl(reinterpret_cast<const sockaddr_in&>(address).sin_addr.s_addr));
    if (address.sa_family == AF_INET6) return nearness_of_v6(reinterpret_cast<const sockaddr_in6&>(address).sin6_addr);
    return Nearness::kOwnMachine;
}

std::optional<Nearness> nearness_of(const char* ip) {
    in_addr v4 = {};
    in6_addr v6 = {};
    if (inet_pton(AF_INET, ip, &v4) == 1) return nearness_of_v4(ntohl(v4.s_addr));
    if (inet_pton(AF_INET6, ip, &v6) == 1) return nearness_of_v6(v6);
    return std::nullopt;
}

}  // namespace neuvv
