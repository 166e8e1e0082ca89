// A hand in the stage: its pose, its buttons, and what its pointer ray hits.
#pragma once

#include <cmath>
#include <optional>
#include <utility>

#include "xr/analogue_input.h"
#include "xr/hands.h"

namespace neuvv::headset {

// The nearest thing that a pointer ray hits.
struct PointerHit {
    enum class Target { kNothing, kPanel, kPerformer, kMarker, kSet, kFloor } target = Target::kNothing;
    double distance_m = 0;   // along the ray
    glm::dvec2 panel_uv{0};  // on the panel: 0..1 from the upper left
    uint32_t performer = 0;  // index into Stage::performers
    uint32_t node = 0;       // of the light or camera of a marker
    // Linear, without the stage's lights: of the performer's surface that the ray meets. Empty where the ray meets only
    // the performer's box.
    std::optional<glm::vec3> colour;
};

struct Hand {
    xr::HandInput input;                // of this frame
    std::optional<xr::Pose> aim, grip;  // world
    xr::AnalogueButton select, grab;
    xr::Flick flick;
    PointerHit hit;                        // of this frame
    std::optional<uint32_t> pointed_node;  // of the performer, light or camera that the ray hits
    // The present press of select. A press belongs to what the ray hit when it began; on the panel, the hit follows the
    // ray for as long as the ray stays on the panel.
    PointerHit pressed_on;
    double select_down_s = 0;          // how long select has been down
    bool press_pending = false;        // the press has begun, and nothing has reacted to it yet
    bool long_press = false;           // the press has had an effect as a long press
    bool deselect_on_release = false;  // unless the press becomes a long one
    bool aiming_teleport = false;      // the stick is pushed
    double teleport_turn_rad = 0;      // by how much to the left it is turned from its upper end
    double vibration = 0;              // strength 0..1 that this frame asks for

    // Whether a press has begun that nothing has reacted to yet: true once for each press, in the frame in which it
    // begins, or in the first one in which edits are possible again.
    bool consume_press() { return std::exchange(press_pending, false); }
    void vibrate(double strength) { vibration = std::max(vibration, strength); }
};

// By role: xr::kRight is the hand that paints, turns the user and changes the speed. Of left-handed users it is the
// left one (HeadsetState::hand_of).
using Hands = std::array<Hand, xr::kHands>;

// Whether a hand begins to hold what its ray hits. Without a grab button, a long press of select on such a target does.
inline bool starts_grab(Hand& hand, PointerHit::Target target) {
    constexpr double kLongPress_s = 0.35;
    if (hand.input.has_grab) return hand.grab.pressed();
    if (hand.select_down_s <= kLongPress_s || hand.long_press) return false;
    hand.long_press = hand.pressed_on.target == target;
    return hand.long_press;
}
inline bool ends_grab(const Hand& hand) {
    return hand.input.has_grab ? !hand.grab.is_down() : !hand.select.is_down();
}
constexpr double kStickDeadZone = 0.15;
// How far the stick of a hand pushes away in this frame what the hand holds; negative: pulls nearer.
inline double pushed_m(const Hand& hand, double dt_s) {
    constexpr double kPush_m_per_s = 2.5;
    const double stick = hand.input.stick.y;
    return std::abs(stick) > kStickDeadZone ? stick * kPush_m_per_s * dt_s : 0;
}

}  // namespace neuvv::headset
