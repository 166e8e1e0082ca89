// Poses that come in UDP packets: of the VMC protocol, or as lines of JSON.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "motion/live/pose_source.h"

namespace neuvv::motion {

// Listens on a port; `host` and errors as UdpSocket. `address` is what the user wrote. The source belongs to whom the
// first valid packet came from, until 2 s after the last valid one.
std::unique_ptr<PoseSource> listen_for_vmc(const std::string& host, uint16_t port, const std::string& address);
std::unique_ptr<PoseSource> listen_for_json(const std::string& host, uint16_t port, const std::string& address);

}  // namespace neuvv::motion
