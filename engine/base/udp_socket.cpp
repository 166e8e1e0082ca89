#include "base/udp_socket.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>

#include "base/error.h"

namespace neuvv {

namespace {

using AddressInfo = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

// Names are not looked up, which could take seconds.
AddressInfo address_info(const std::string& host, uint16_t port, const std::string& address) {
    addrinfo hints{};
    hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV | AI_PASSIVE;
    hints.ai_socktype = SOCK_DGRAM;
    addrinfo* found = nullptr;
    const std::string digits = host == "localhost" ? "127.0.0.1" : host;
    if (getaddrinfo(digits.c_str(), std::to_string(port).c_str(), &hints, &found) != 0)
        throw InputError(address, "", fmt::format("\"{}\" is no address of a network", host),
                         "write digits, as 127.0.0.1 for this machine alone or 0.0.0.0 for its whole network");
    return {found, &freeaddrinfo};
}

[[noreturn]] void fail_to_bind(int error, const std::string& host, uint16_t port, const std::string& address) {
    if (error == EADDRINUSE)
        throw InputError(address, "", fmt::format("another program listens on port {} of {}", port, host),
                         "close it, or choose another port here and where the poses are sent from");
    if (error == EADDRNOTAVAIL)
        throw InputError(address, "", fmt::format("{} is no address of this machine", host),
                         "write 127.0.0.1 for this machine alone or 0.0.0.0 for its whole network");
    if (error == EACCES)
        throw InputError(address, "", fmt::format("port {} is the system's", port), "choose one above 1023");
    throw RuntimeFailure(fmt::format("{}: cannot listen: {}", address, std::strerror(error)));
}

// The two kinds of addresses, read from the bytes of a sockaddr_storage.
template <typename Address>
Address address_of(const sockaddr_storage& storage) {
    Address address{};
    std::memcpy(&address, &storage, sizeof address);
    return address;
}

UdpSender sender_of(const sockaddr_storage& storage) {
    UdpSender sender;
    if (storage.ss_family == AF_INET6) {
        const auto address = address_of<sockaddr_in6>(storage);
        std::memcpy(sender.host.data(), &address.sin6_addr, sizeof address.sin6_addr);
        sender.port = ntohs(address.sin6_port);
    } else {
        const auto address = address_of<sockaddr_in>(storage);
        std::memcpy(sender.host.data(), &address.sin_addr, sizeof address.sin_addr);
        sender.port = ntohs(address.sin_port);
    }
    return sender;
}

}  // namespace

UdpSocket::UdpSocket(const std::string& host, uint16_t port, const std::string& address)
    : host_(host.find(':') == std::string::npos ? host : "[" + host + "]"), buffer_(kLargestPacket) {
    const AddressInfo info = address_info(host, port, address);
    socket_ = socket(info->ai_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    if (socket_ < 0) throw RuntimeFailure(fmt::format("{}: no socket: {}", address, std::strerror(errno)));
    const int half = kWaiting_bytes / 2;  // Linux doubles the number
    const bool bounded = setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &half, sizeof half) == 0;
    if (!bounded || bind(socket_, info->ai_addr, info->ai_addrlen) != 0) {
        const int error = errno;
        close(socket_);
        fail_to_bind(error, host_, port, address);
    }
}

UdpSocket::~UdpSocket() {
    close(socket_);
}

std::optional<UdpPacket> UdpSocket::receive() {
    sockaddr_storage from{};
    iovec part{buffer_.data(), buffer_.size()};
    msghdr message{};
    message.msg_name = &from;
    message.msg_namelen = sizeof from;
    message.msg_iov = &part;
    message.msg_iovlen = 1;
    ssize_t bytes = -1;
    do bytes = recvmsg(socket_, &message, 0);
    while (bytes < 0 && errno == EINTR);
    if (bytes < 0) return std::nullopt;
    return UdpPacket{
        {buffer_.data(), static_cast<size_t>(bytes)}, sender_of(from), (message.msg_flags & MSG_TRUNC) != 0};
}

std::string UdpSocket::name() const {
    sockaddr_storage bound{};
    socklen_t size = sizeof bound;
    if (getsockname(socket_, reinterpret_cast<sockaddr*>(&bound), &size) != 0) return host_;
    return fmt::format("{}:{}", host_, sender_of(bound).port);
}

UdpOutput::UdpOutput(uint16_t port) : socket_(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (socket_ >= 0 && connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0) return;
    const int error = errno;
    if (socket_ >= 0) close(socket_);
    throw RuntimeFailure(fmt::format("cannot send to port {}: {}", port, std::strerror(error)));
}

UdpOutput::~UdpOutput() {
    close(socket_);
}

void UdpOutput::send(std::span<const uint8_t> packet) const {
    if (::send(socket_, packet.data(), packet.size(), 0) != static_cast<ssize_t>(packet.size()))
        throw RuntimeFailure(fmt::format("cannot send a packet: {}", std::strerror(errno)));
}

}  // namespace neuvv
