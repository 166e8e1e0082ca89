// A hand in the stage: its pose, its buttons, and what its pointer ray hits.
#pragma once

#include <optional>
#include <utility>

#include "xr/analogue_input.h"
#include "xr/hands.h"

namespace neuvv::headset {

// The nearest thing that a pointer ray hits.
struct PointerHit {
    enum class Target { kNothing, kPanel, kPerformer, kFloor } target = Target::kNothing;
    double distance_m = 0;   // along the ray
    glm::dvec2 panel_uv{0};  // on the panel: 0..1 from the upper left
    uint32_t performer = 0;  // index into Stage::performers
};

struct Hand {
    xr::HandInput input;                // of this frame
    std::optional<xr::Pose> aim, grip;  // world
    xr::AnalogueButton select, grab;
    xr::Flick flick;
    PointerHit hit;                        // of this frame
    std::optional<uint32_t> pointed_node;  // of the performer that the ray hits
    // The present press of select. A press belongs to what the ray hit when it began; on the panel, the hit follows the
    // ray for as long as the ray stays on the panel.
    PointerHit pressed_on;
    double select_down_s = 0;          // how long select has been down
    bool press_pending = false;        // the press has begun, and nothing has reacted to it yet
    bool long_press = false;           // the press has had an effect as a long press
    bool deselect_on_release = false;  // unless the press becomes a long one
    bool aiming_teleport = false;      // the stick is pushed
    double vibration = 0;              // strength 0..1 that this frame asks for

    // Whether a press has begun that nothing has reacted to yet: true once for each press, in the frame in which it
    // begins, or in the first one in which edits are possible again.
    bool consume_press() { return std::exchange(press_pending, false); }
    void vibrate(double strength) { vibration = std::max(vibration, strength); }
};

using Hands = std::array<Hand, xr::kHands>;

}  // namespace neuvv::headset
