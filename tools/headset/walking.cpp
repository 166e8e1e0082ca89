#include "tools/headset/walking.h"

#include <glm/gtc/constants.hpp>

#include "tools/headset/holding.h"

namespace neuvv::headset {

namespace {

constexpr double kThrow = 0.7, kLetGo = 0.35;  // of the stick

}  // namespace

void Walking::update(OnStage& on, Hands& hands, const std::array<bool, xr::kHands>& free, const xr::Pose& head,
                     double dt_s) {
    arc_.reset();
    const xr::XrRig before = on.rig;
    Hand& left = hands[xr::kLeft];
    Hand& right = hands[xr::kRight];
    if (free[xr::kLeft] && on.comfort.smooth_walk)
        on.rig = xr::walked(on.rig, head, left.input.stick, on.comfort.walk_m_per_s, dt_s);
    else if (free[xr::kLeft])
        teleport(on, left, head);
    const double speed = dt_s > 0 ? glm::distance(before.position, on.rig.position) / dt_s : 0;
    if (free[xr::kRight]) turn(on, right, head, dt_s);
    const double turned = std::remainder(on.rig.yaw_rad - before.yaw_rad, glm::two_pi<double>());
    const bool smooth = on.comfort.smooth_walk || on.comfort.smooth_turn;
    const double wanted =
        on.comfort.vignette && smooth && dt_s > 0
            ? xr::vignette_of(on.comfort.smooth_walk ? speed : 0, on.comfort.smooth_turn ? std::abs(turned) / dt_s : 0)
            : 0;
    vignette_ += (wanted - vignette_) * std::min(1.0, 12 * dt_s);
    if (vignette_ < 0.01) vignette_ = 0;
}

// Aimed while the stick is pushed, done when it comes back.
void Walking::teleport(OnStage& on, Hand& hand, const xr::Pose& head) {
    const double pushed = hand.input.stick.y;
    const bool aims = hand.throws_arc ? pushed > kLetGo : pushed > kThrow && pushed > std::abs(hand.input.stick.x);
    if (hand.aim && (aims || hand.throws_arc)) {
        const xr::Arc arc = xr::teleport_arc(*hand.aim, on.floor_m);
        if (aims) {
            arc_ = arc;
        } else if (arc.landing) {
            on.rig = xr::with_head_above(on.rig, head, *arc.landing);
            hand.feel(0.4);
        }
    }
    hand.throws_arc = aims;
}

void Walking::turn(OnStage& on, Hand& hand, const xr::Pose& head, double dt_s) {
    if (on.comfort.smooth_turn) {
        const double stick = std::abs(hand.input.stick.x) > 0.15 ? hand.input.stick.x : 0;
        on.rig = xr::turned_about_head(on.rig, head, -stick * glm::radians(on.comfort.turn_deg_per_s) * dt_s);
        return;
    }
    const int steps = hand.flick.went_right() - hand.flick.went_left();
    if (steps == 0) return;
    on.rig = xr::turned_about_head(on.rig, head, -steps * glm::radians(on.comfort.snap_deg));
    hand.feel(0.15);
}

}  // namespace neuvv::headset
