// A stage for programs that know no clips: splats stand in for performers.
#pragma once

#include <filesystem>
#include <glm/gtc/quaternion.hpp>
#include <span>

#include "interchange/splats/splats.h"
#include "stage/stage.h"

namespace neuvv::interchange {

// What stands in for a performer.
struct StandIn {
    uint32_t node = 0;            // of the performer
    size_t splats = 0;            // index among those that are written, in the space of the performer
    glm::dquat turn{1, 0, 0, 0};  // of the splats about the node's origin
};

// Whether performers have stand-ins that write_stand_ins put there.
bool has_stand_ins(const stage::Stage& stage);

// Writes a .glb of the whole stage, with its buffers and images: the node of each stand-in gets a child whose mesh are
// splats of KHR_gaussian_splatting. This program leaves those out, and shows the clips, which stay where they are.
// `splats` are written once, however many nodes have them; none of them may be empty. Written atomically; throws
// InputError as stage::embedded does, and where this program could not read the file again because of its size, and
// RuntimeFailure.
void write_stand_ins(const std::filesystem::path& output, const stage::Stage& stage, std::span<const Splats> splats,
                     std::span<const StandIn> stand_ins);

}  // namespace neuvv::interchange
