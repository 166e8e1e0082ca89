// A hand in the stage: where it is, what it presses and what it points at.
#pragma once

#include <optional>
#include <utility>

#include "xr/analogue_input.h"
#include "xr/hands.h"

namespace neuvv::headset {

// Something that a ray meets.
struct PointedAt {
    enum class What { kNothing, kPanel, kPerformer, kFloor } what = What::kNothing;
    double metres = 0;       // along the ray
    glm::dvec2 on_panel{0};  // 0..1 from the upper left
    uint32_t performer = 0;  // of Stage::performers
};

struct Hand {
    xr::HandInput input;                // of this frame
    std::optional<xr::Pose> aim, grip;  // world
    xr::AnalogueButton select, grab;
    xr::Flick flick;
    PointedAt at;
    double selecting_s = 0;  // for how long select has been held
    PointedAt pressed;   // what select was pressed on, while it is held; of the panel where it points now, or did last
    bool fresh = false;  // that press was begun, and nothing has been done by it
    bool held_long = false;   // that press has been taken for a long one
    bool deselects = false;   // it will, where it does not become one
    bool throws_arc = false;  // the stick is pushed for a teleport
    // What it may feel at the frame's end, 0..1.
    double pulse = 0;

    // A press is taken once, in the frame in which it is begun or in the first in which edits are possible again.
    bool takes_press() { return std::exchange(fresh, false); }
    void feel(double strength) { pulse = std::max(pulse, strength); }
};

using Hands = std::array<Hand, xr::kHands>;

}  // namespace neuvv::headset
