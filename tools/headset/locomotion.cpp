#include "tools/headset/locomotion.h"

#include <glm/gtc/constants.hpp>

#include "tools/headset/performer_grab.h"

namespace neuvv::headset {

namespace {

constexpr double kAimFrom = 0.7,
                 kAimUntil = 0.35;  // of the stick: aiming begins above the first and ends below the second

}  // namespace

void Locomotion::update(HeadsetState& state, Hands& hands, const std::array<bool, xr::kHands>& stick_free,
                        const xr::Pose& head, double dt_s) {
    arc_.reset();
    const xr::XrRig before = state.rig;
    Hand& left = hands[xr::kLeft];
    Hand& right = hands[xr::kRight];
    if (stick_free[xr::kLeft] && state.comfort.smooth_walk)
        state.rig = xr::walked(state.rig, head, left.input.stick, state.comfort.walk_m_per_s, dt_s);
    else if (stick_free[xr::kLeft])
        teleport(state, left, head);
    const double speed = dt_s > 0 ? glm::distance(before.position, state.rig.position) / dt_s : 0;
    if (stick_free[xr::kRight]) turn(state, right, head, dt_s);
    const double turned = std::remainder(state.rig.yaw_rad - before.yaw_rad, glm::two_pi<double>());
    state.ahead_rad += turned;
    const bool smooth = state.comfort.smooth_walk || state.comfort.smooth_turn;
    const double target = state.comfort.vignette && smooth && dt_s > 0
                              ? xr::vignette_of(state.comfort.smooth_walk ? speed : 0,
                                                state.comfort.smooth_turn ? std::abs(turned) / dt_s : 0)
                              : 0;
    vignette_ += (target - vignette_) * std::min(1.0, 12 * dt_s);
    if (vignette_ < 0.01) vignette_ = 0;
}

// The user aims while the stick is pushed, and teleports when it comes back.
void Locomotion::teleport(HeadsetState& state, Hand& hand, const xr::Pose& head) {
    const double pushed = hand.input.stick.y;
    const bool aims =
        hand.aiming_teleport ? pushed > kAimUntil : pushed > kAimFrom && pushed > std::abs(hand.input.stick.x);
    if (hand.aim && (aims || hand.aiming_teleport)) {
        const xr::Arc arc = xr::teleport_arc(*hand.aim, state.floor_m);
        if (aims) {
            arc_ = arc;
        } else if (arc.landing) {
            state.rig = xr::with_head_above(state.rig, head, *arc.landing);
            hand.vibrate(0.4);
        }
    }
    hand.aiming_teleport = aims;
}

void Locomotion::turn(HeadsetState& state, Hand& hand, const xr::Pose& head, double dt_s) {
    if (state.comfort.smooth_turn) {
        const double stick = std::abs(hand.input.stick.x) > 0.15 ? hand.input.stick.x : 0;
        state.rig = xr::turned_about_head(state.rig, head, -stick * glm::radians(state.comfort.turn_deg_per_s) * dt_s);
        return;
    }
    const int steps = hand.flick.went_right() - hand.flick.went_left();
    if (steps == 0) return;
    state.rig = xr::turned_about_head(state.rig, head, -steps * glm::radians(state.comfort.snap_deg));
    hand.vibrate(0.15);
}

}  // namespace neuvv::headset
