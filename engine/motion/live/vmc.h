// The body that a program of the VMC protocol (Virtual Motion Capture) sends, bone by bone.
#pragma once

#include <array>
#include <bitset>
#include <cstdint>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>
#include <optional>
#include <span>
#include <string>

#include "motion/skeleton/humanoid.h"

namespace neuvv::motion {

constexpr size_t kVmcBones = 22;  // of the VRM humanoid, without fingers, eyes and jaw

// README.md says which messages are read, and how their space becomes ours.
class VmcBody {
  public:
    // Takes a packet, as a whole or not at all; the status of one without bones only where `status_counts`. Returns
    // whether it had bones. Throws InputError with `stream` where the packet is malformed, or has a number that cannot
    // be.
    bool read(std::span<const uint8_t> packet, const std::string& stream, bool status_counts = true);

    struct Poses {
        Pose newest;
        uint64_t count = 0;  // since the last call
    };
    // What came since the last call; nothing where no bone did, or where the first bones of a body have just come.
    // Throws InputError with `stream` where bones are missing that a body needs, or where the sender says that nobody
    // is tracked.
    std::optional<Poses> take(const std::string& stream);

  private:
    struct Transform {
        glm::dvec3 place{0};
        glm::dquat turn{1, 0, 0, 0};
    };
    struct BoneMove {
        size_t bone = 0;
        Transform local;
    };

    void move(const BoneMove& move);
    void end_pose();
    std::array<glm::dmat4, kVmcBones> world_from_bones() const;

    Transform root_;
    std::array<Transform, kVmcBones> local_;  // from the bone to its parent
    std::bitset<kVmcBones> known_;            // bones that came at any time
    std::bitset<kVmcBones> came_;             // those of the pose that has not ended
    bool whole_ = false;                      // a bone came twice, so every bone of the body has come once
    bool tracked_ = true;
    uint64_t ended_ = 0;                   // poses since the last call of take()
    std::optional<JointSources> sources_;  // of the body at rest; nothing: its bones have changed
};

}  // namespace neuvv::motion
