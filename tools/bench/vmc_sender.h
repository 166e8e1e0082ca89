// A program that sends a body by the VMC protocol to a port of this machine.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/udp_socket.h"
#include "motion/skeleton/skeleton.h"

namespace neuvv::bench {

// A packet with all bones of the pose of a body whose bones have these lengths (motion::bone_lengths, metres). Bones
// have no twist, and the head looks where the trunk does. The joints of hips, shoulders, arms and legs must be known.
std::vector<uint8_t> vmc_packet(const motion::Pose& pose, const std::array<double, motion::kJoints>& lengths);

class VmcSender {
  public:
    // The address of a listener, as PoseSource::name() has it: "VMC on 127.0.0.1:39539". Throws RuntimeFailure.
    explicit VmcSender(const std::string& listener);
    void send(std::span<const uint8_t> packet) const { output_.send(packet); }

  private:
    UdpOutput output_;
};

}  // namespace neuvv::bench
