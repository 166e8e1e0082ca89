// The shapes of hands, pointer rays, boxes, arcs, brushes, joints, and of a floor where a stage has none.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tools/headset/interaction.h"
#include "xr/eye_shapes.h"
#include "xr/hand_tracking.h"

namespace neuvv::headset {

// A grid of lines one metre apart around the user, where the stage has no set to stand on.
void draw_floor(xr::EyeShapes& shapes, const HeadsetState& state);
void draw_interaction(xr::EyeShapes& shapes, const HeadsetState& state, const Interaction& interaction);
// The joints of a bare hand, which are in the tracking space.
void draw_joints(xr::EyeShapes& shapes, const xr::HandJoints& joints, const xr::Pose& world_from_tracking);

// Named joints to be drawn over a performer, so that a motion can be compared with the performer's.
struct JointOverlay {
    struct Joint {
        std::string name;
        glm::dvec3 position{0};              // performer's space, metres
        glm::vec4 colour{0.2f, 0.7f, 1, 1};  // linear
    };
    std::vector<Joint> joints;
    std::vector<std::pair<uint32_t, uint32_t>> bones;  // pairs of indices into `joints`
};
void draw_overlay(xr::EyeShapes& shapes, const JointOverlay& overlay, const glm::dmat4& world_from_performer);

}  // namespace neuvv::headset
