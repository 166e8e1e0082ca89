// UDP packets that arrive at a port of this machine, or that this program sends to one.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace neuvv {

// Who sent a packet: an address of IPv4, in its first four bytes, or of IPv6, and a port.
struct UdpSender {
    std::array<uint8_t, 16> host{};
    uint16_t port = 0;
    bool operator==(const UdpSender&) const = default;
};

struct UdpPacket {
    std::span<const uint8_t> bytes;  // valid until the next call of receive()
    UdpSender sender;
    bool cut = false;  // the packet was larger than kLargestPacket; only its beginning is here
};

class UdpSocket {
  public:
    static constexpr size_t kLargestPacket = 1 << 14;
    // More packets than this never wait: the socket's buffer has kWaiting_bytes, and the system counts 768 bytes or
    // more for a packet.
    static constexpr int kWaiting_bytes = 1 << 18;
    static constexpr size_t kMostWaiting = 512;

    // `host` is an address in digits (IPv4 or IPv6) or "localhost"; port 0 takes one that is free. Throws InputError
    // with `address`, as the user wrote it, and the fix, where the port is in use or the host is none of this machine.
    UdpSocket(const std::string& host, uint16_t port, const std::string& address);
    ~UdpSocket();
    UdpSocket(const UdpSocket&) = delete;
    UdpSocket& operator=(const UdpSocket&) = delete;

    // The packet that has waited longest, or nothing where none waits. It never makes the caller wait.
    std::optional<UdpPacket> receive();
    std::string name() const;  // "127.0.0.1:39539", "[::1]:39539"

  private:
    int socket_ = -1;
    std::string host_;
    std::vector<uint8_t> buffer_;
};

class UdpOutput {
  public:
    // Sends to a port of this machine. Throws RuntimeFailure, as send() does.
    explicit UdpOutput(uint16_t port);
    ~UdpOutput();
    UdpOutput(const UdpOutput&) = delete;
    UdpOutput& operator=(const UdpOutput&) = delete;

    // The packet waits at the port when this returns.
    void send(std::span<const uint8_t> packet) const;

  private:
    int socket_ = -1;
};

}  // namespace neuvv
