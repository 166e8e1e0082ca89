// Programs that send poses: a UDP socket, and the packets of the VMC protocol.
#pragma once

#include <lo/lo.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <stdexcept>
#include <string>
#include <vector>

namespace neuvv::test {

using VmcNumbers = std::vector<float>;  // place and quaternion, of Unity

struct VmcPart {
    std::string path;
    std::string name;
    VmcNumbers numbers;
};

// An OSC message "sfff...", or without a name "iii...".
inline lo_message vmc_message(const VmcPart& part) {
    lo_message message = lo_message_new();
    if (!part.name.empty()) lo_message_add_string(message, part.name.c_str());
    for (const float number : part.numbers)
        if (part.name.empty())
            lo_message_add_int32(message, static_cast<int32_t>(number));
        else
            lo_message_add_float(message, number);
    return message;
}

inline std::string vmc_packet(const VmcPart& part) {
    lo_message message = vmc_message(part);
    std::string bytes(lo_message_length(message, part.path.c_str()), '\0');
    lo_message_serialise(message, part.path.c_str(), bytes.data(), nullptr);
    lo_message_free(message);
    return bytes;
}

inline std::string vmc_bundle(const std::vector<VmcPart>& parts) {
    lo_bundle bundle = lo_bundle_new(LO_TT_IMMEDIATE);
    for (const VmcPart& part : parts) lo_bundle_add_message(bundle, part.path.c_str(), vmc_message(part));
    std::string bytes(lo_bundle_length(bundle), '\0');
    lo_bundle_serialise(bundle, bytes.data(), nullptr);
    lo_bundle_free_recursive(bundle);
    return bytes;
}

class UdpTransmitter {
  public:
    // `machine`: from 127.0.0.N, as if it were another machine.
    explicit UdpTransmitter(uint32_t machine = 1) : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
        sockaddr_in from{};
        from.sin_family = AF_INET;
        from.sin_addr.s_addr = htonl((INADDR_LOOPBACK & ~0xffu) + machine);
        if (socket_ < 0 || bind(socket_, reinterpret_cast<const sockaddr*>(&from), sizeof from) != 0)
            throw std::runtime_error("no socket");
    }
    UdpTransmitter(const UdpTransmitter&) = delete;
    UdpTransmitter& operator=(const UdpTransmitter&) = delete;
    ~UdpTransmitter() { close(socket_); }

    // On this machine, a packet waits at the port when this returns, or was dropped because too many do.
    void send(const std::string& bytes, uint16_t port) const {
        sockaddr_in to{};
        to.sin_family = AF_INET;
        to.sin_port = htons(port);
        to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        const auto* address = reinterpret_cast<const sockaddr*>(&to);
        if (sendto(socket_, bytes.data(), bytes.size(), 0, address, sizeof to) != static_cast<ssize_t>(bytes.size()))
            throw std::runtime_error("cannot send");
    }

  private:
    int socket_;
};

}  // namespace neuvv::test
