// Where the user stands on the stage: at the beginning, and after the tracking space was centred anew.
#pragma once

#include "tools/headset/state/headset_state.h"
#include "xr/session.h"

namespace neuvv::headset {

// A place on the floor, and a heading (xr::yaw_of).
struct StandingPlace {
    glm::dvec3 floor_point{0};  // world
    double yaw_rad = 0;
};

// Where a user begins: on the floor below the stage's first perspective camera, with its heading; without such a
// camera, in front of the performers. Who would stand nearer than kNearest_m or farther than kFarthest_m from the
// nearest performer comes to stand in between, ahead of that place or behind it; where nobody is ahead, towards the
// nearest performer and facing it.
StandingPlace first_place(const HeadsetState& state);
// From the centre of what is solid of a performer, or from half a metre inside of its box where that is nearer.
constexpr double kNearest_m = 2, kFarthest_m = 2.5;

// Moves the user there. `head` is in the tracking space.
void stand_at(HeadsetState& state, const StandingPlace& place, const xr::Pose& head);

// Follows a change of the tracking space. `before` is the head's last pose in the old space, `now` its pose in the new
// one. The user stays in the same place on the stage. A user who has asked for the change, in order to look ahead, now
// looks straight ahead (HeadsetState::ahead_rad); else the user goes on looking in the same direction.
void follow_tracking_change(HeadsetState& state, const xr::TrackingChange& change, const xr::Pose& before,
                            const xr::Pose& now);

}  // namespace neuvv::headset
