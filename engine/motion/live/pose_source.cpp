#include "motion/live/pose_source.h"

#include <fmt/format.h>

#include <charconv>

#include "base/error.h"
#include "base/line_reader.h"
#include "motion/live/line_source.h"
#include "motion/live/packet_source.h"
#include "motion/live/pose_replay.h"

namespace neuvv::motion {

namespace {

constexpr uint16_t kVmcPort = 39539;  // where the protocol's receivers of motion listen

struct PortAddress {
    std::string host = "127.0.0.1";
    uint16_t port = kVmcPort;
};

// What stands behind "vmc:" or "udp:": PORT or HOST:PORT; an address of IPv6 may stand in brackets.
PortAddress read_port_address(const std::string& address) {
    const std::string kind = address.substr(0, 3), text = address.substr(std::min<size_t>(4, address.size()));
    const size_t colon = text.rfind(':');
    PortAddress result;
    const std::string digits = colon == std::string::npos ? text : text.substr(colon + 1);
    const char* const end = digits.data() + digits.size();
    const auto [read_to, error] = std::from_chars(digits.data(), end, result.port);
    if (error != std::errc() || read_to != end)
        throw InputError(address, "", fmt::format("\"{}\" is no port from 0 to 65535", digits.substr(0, 40)),
                         fmt::format("write {0}:PORT or {0}:HOST:PORT, as {0}:{1}", kind, kVmcPort));
    if (colon != std::string::npos) result.host = text.substr(0, colon);
    if (result.host.starts_with('[') && result.host.ends_with(']'))
        result.host = result.host.substr(1, result.host.size() - 2);
    return result;
}

}  // namespace

bool is_port_address(const std::string& address) {
    return address == "vmc" || address.starts_with("vmc:") || address == "udp" || address.starts_with("udp:");
}

std::unique_ptr<PoseSource> open_pose_source(const std::string& address) {
    if (address == "-") return read_lines_of_poses(kStandardInput, "stdin");
    if (!is_port_address(address)) return replay_poses(address);
    const PortAddress at = address == "vmc" ? PortAddress() : read_port_address(address);
    return address.starts_with("vmc") ? listen_for_vmc(at.host, at.port, address)
                                      : listen_for_json(at.host, at.port, address);
}

}  // namespace neuvv::motion
