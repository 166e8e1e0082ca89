#include "tools/headset/hands/locomotion.h"

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <utility>

#include "base/box.h"
#include "tools/headset/hands/performer_grab.h"

namespace neuvv::headset {

namespace {

constexpr double kAimFrom = 0.7,
                 kAimUntil = 0.35;  // of the stick: aiming begins above the first and ends below the second
// A stick that is turned by less leaves the heading as it is; one that is pushed less far says nothing about it.
constexpr double kKeepsHeading_rad = glm::radians(30.0), kTurnsFrom = 0.7;
constexpr double kFadeIn_s = 0.25;
// The vignette comes at once and goes slowly, so that it does not flicker.
constexpr double kDarker_per_s = 12, kBrighter_per_s = 4;
constexpr double kHead_m = 1.9;     // above the floor: who floats higher is in nobody's way
constexpr double kBeyond_m = 1e-6;  // of the edge of what is not free

// The points on the floor that lie beside a performer's box, on each of its sides, straight out from `at`; none where
// `at` is outside.
std::vector<glm::dvec3> ways_out(const HeadsetState& state, const stage::EvaluatedPerformer& performer, glm::dvec3 at) {
    const auto [low, high] = editor::box_of(state, performer.performer);
    const glm::dmat4& world = performer.world_from_performer;
    if (!performer.visible || above_floor(world, low, high, state.floor_m) > kHead_m) return {};
    const glm::dvec3 centre = world * glm::dvec4(0.5 * (low + high), 1);
    std::vector<glm::dvec3> ways;
    for (const int axis : {0, 2}) {
        glm::dvec3 along(world[axis].x, 0, world[axis].z);
        const double scale = glm::length(along);
        if (!(scale > 0)) return {};
        along /= scale;
        const double half_m = 0.5 * (high[axis] - low[axis]) * scale + kBesidePerformer_m;
        const double aside_m = glm::dot(at - centre, along);
        if (std::abs(aside_m) >= half_m) return {};
        for (const double side : {-1.0, 1.0}) ways.push_back(at + (side * (half_m + kBeyond_m) - aside_m) * along);
    }
    return ways;
}

// The free place that is nearest to `from`, among those that one finds from `at` by leaving so many boxes.
void find_free(const HeadsetState& state, glm::dvec3 from, glm::dvec3 at, int boxes, std::optional<glm::dvec3>& best) {
    if (best && glm::distance(from, at) >= glm::distance(from, *best)) return;
    for (const stage::EvaluatedPerformer& performer : state.evaluated.performers) {
        const std::vector<glm::dvec3> ways = ways_out(state, performer, at);
        if (ways.empty()) continue;
        for (size_t i = 0; i < ways.size() && boxes > 0; ++i) find_free(state, from, ways[i], boxes - 1, best);
        return;
    }
    best = at;
}

}  // namespace

std::optional<glm::dvec3> free_landing(const HeadsetState& state, glm::dvec3 landing) {
    constexpr int kBoxes = 3;
    std::optional<glm::dvec3> best;
    find_free(state, landing, landing, kBoxes, best);
    return best;
}

void Locomotion::update(HeadsetState& state, Hands& hands, const std::array<bool, xr::kHands>& stick_free,
                        const xr::Pose& head, double dt_s) {
    arc_.reset();
    arc_yaw_.reset();
    const double raised_m = state.shows_room ? 0 : state.comfort.raised_m;
    state.rig.position.y += raised_m - std::exchange(state.raised_m, raised_m);
    shade_.fade = std::max(0.0, shade_.fade - dt_s / kFadeIn_s);
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
    const double rate_per_s = target > shade_.vignette ? kDarker_per_s : kBrighter_per_s;
    shade_.vignette += (target - shade_.vignette) * std::min(1.0, rate_per_s * dt_s);
    if (shade_.vignette < 0.01) shade_.vignette = 0;
}

// The user aims while the stick is pushed, and teleports when it comes back. A stick that is turned aside meanwhile
// says by how much the user will have turned.
void Locomotion::teleport(HeadsetState& state, Hand& hand, const xr::Pose& head) {
    const glm::dvec2 stick = hand.input.stick;
    const double pushed = glm::length(stick);
    const bool aims = hand.aiming_teleport ? pushed > kAimUntil : stick.y > kAimFrom && stick.y > std::abs(stick.x);
    if (aims && !hand.aiming_teleport) hand.teleport_turn_rad = 0;
    if (aims && pushed > kTurnsFrom) hand.teleport_turn_rad = std::atan2(-stick.x, stick.y);
    if (hand.aim && (aims || hand.aiming_teleport)) {
        xr::Arc arc = xr::teleport_arc(*hand.aim, state.floor_m);
        if (arc.landing) arc.landing = free_landing(state, *arc.landing);
        std::optional<double> yaw_rad;
        if (std::abs(hand.teleport_turn_rad) > kKeepsHeading_rad)
            yaw_rad = state.rig.yaw_rad + xr::yaw_of(head.rotation) + hand.teleport_turn_rad;
        if (aims) {
            arc_ = arc;
            arc_yaw_ = yaw_rad;
        } else if (arc.landing) {
            state.rig = xr::with_head_above(state.rig, head, *arc.landing + glm::dvec3(0, state.raised_m, 0), yaw_rad);
            fade_in();
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
