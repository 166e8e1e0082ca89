// How hands, rays, boxes, arcs, brushes, joints and a bare floor look in the stage.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tools/headset/interaction.h"
#include "xr/eye_shapes.h"
#include "xr/hand_tracking.h"

namespace neuvv::headset {

// Where there is no set: something to stand on, a metre from line to line.
void draw_floor(xr::EyeShapes& shapes, const OnStage& on);
void draw_interaction(xr::EyeShapes& shapes, const OnStage& on, const Interaction& interaction);
// Bare hands, joint by joint; tracking space.
void draw_joints(xr::EyeShapes& shapes, const xr::HandJoints& joints, const xr::Pose& world_from_tracking);

// Named joints over a performer, where motion is compared with its own: in its space, metres.
struct JointOverlay {
    struct Joint {
        std::string name;
        glm::dvec3 at{0};
        glm::vec4 colour{0.2f, 0.7f, 1, 1};
    };
    std::vector<Joint> joints;
    std::vector<std::pair<uint32_t, uint32_t>> bones;  // between joints
};
void draw_overlay(xr::EyeShapes& shapes, const JointOverlay& overlay, const glm::dmat4& world_from_performer);

}  // namespace neuvv::headset
