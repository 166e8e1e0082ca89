// The shapes of hands, pointer rays, boxes, arcs, brushes, joints, and of a floor where a stage has none.
#pragma once

#include "tools/headset/hands/interaction.h"
#include "xr/draw/eye_shapes.h"
#include "xr/hand_tracking.h"

namespace neuvv::headset {

// Where the stage has no set to stand on: a floor around the user with lines one metre apart, and a shadow on it below
// each performer, which shows where it stands.
void draw_floor(xr::EyeShapes& shapes, const HeadsetState& state);
void draw_interaction(xr::EyeShapes& shapes, const HeadsetState& state, const Interaction& interaction);
// The joints of a bare hand, which are in the tracking space.
void draw_joints(xr::EyeShapes& shapes, const xr::HandJoints& joints, const xr::Pose& world_from_tracking);

}  // namespace neuvv::headset
