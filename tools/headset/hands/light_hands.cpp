#include "tools/headset/hands/light_hands.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "edit/operations.h"
#include "tools/headset/draw/markers.h"
#include "tools/headset/state/arrange.h"

namespace neuvv::headset {

namespace {

constexpr double kDouble_s = 1;  // the time in which a stick that is pushed to its end doubles an opening

bool is_locked(HeadsetState& state, uint32_t node) {
    if (!edit::is_locked(state.editor.file(), node)) return false;
    state.editor.notify("it is locked: unlock it to move it", true);
    return true;
}

// What a light or camera may be aimed at.
bool is_aimed_at(PointerHit::Target target) {
    using enum PointerHit::Target;
    return target == kPerformer || target == kSet || target == kFloor;
}

}  // namespace

void LightHands::press(HeadsetState& state, Hand& hand, int which) {
    const auto selected = selected_marker(state);
    using enum PointerHit::Target;
    if (hand.hit.target == kMarker) {
        state.editor.select(hand.hit.node);
        hand.vibrate(0.5);
    } else if (selected && is_aimed_at(hand.hit.target)) {
        if (!is_locked(state, *selected)) aim_ = Aim{which, *selected, {}};
    } else if (hand.aim) {
        hand.deselect_on_release = true;
    }
}

void LightHands::start_holding(HeadsetState& state, Hand& hand, int which) {
    if (!hand.aim || hand.hit.target != PointerHit::Target::kMarker || is_locked(state, hand.hit.node)) return;
    const uint32_t node = hand.hit.node;
    held_ = Held{which, node, xr::Grab(state.evaluated.pose.world_from_node[node], {.upright = false}), {}};
    held_->grab.attach(which, *hand.aim, hand.hit.distance_m);
    held_->opening = opening_of(state.editor.file(), node);
    state.editor.select(node);
    hand.vibrate(0.7);
}

void LightHands::update(HeadsetState& state, Hands& hands, double dt_s) {
    if (state.tool != HandTool::kLights) return release(state);
    for (int which = 0; which < xr::kHands; ++which) {
        Hand& hand = hands[which];
        const bool lets_go = held_ && held_->hand == which && ends_grab(hand);
        const bool has_aimed = aim_ && aim_->hand == which && !hand.select.is_down();
        if (lets_go || has_aimed) {
            release(state);
            hand.vibrate(0.3);
        }
        if (is_active()) continue;
        if (hand.hit.target != PointerHit::Target::kPanel && hand.consume_press()) press(state, hand, which);
        if (!is_active() && starts_grab(hand, PointerHit::Target::kMarker)) start_holding(state, hand, which);
    }
    if (state.is_behind()) return;
    if (held_) show_held(state, hands, dt_s);
    if (aim_) show_aim(state, hands);
}

// To the right, the stick widens the opening; to the left, it narrows it.
void LightHands::open_held(Held& held, const Hand& hand, double dt_s) {
    const double stick = hand.input.stick.x;
    if (!held.opening || std::abs(stick) < kStickDeadZone) return;
    Opening& opening = *held.opening;
    opening.degrees = std::clamp(opening.degrees * std::exp2(stick * dt_s / kDouble_s), opening.low, opening.high);
    held.has_opened = true;
}

void LightHands::show_held(HeadsetState& state, Hands& hands, double dt_s) {
    const Hand& hand = hands[held_->hand];
    if (hand.aim) held_->grab.move(held_->hand, *hand.aim);
    const bool is_sideways = std::abs(hand.input.stick.x) > std::abs(hand.input.stick.y);
    if (is_sideways)
        open_held(*held_, hand, dt_s);
    else if (const double by_m = pushed_m(hand, dt_s); by_m != 0)
        held_->grab.push(held_->hand, by_m);
    editor::move_node(state.evaluated, *state.stage, held_->node, held_->grab.world_from_node());
    if (held_->has_opened) show_opening(state.evaluated, state.editor.file(), held_->node, held_->opening->degrees);
}

void LightHands::show_aim(HeadsetState& state, const Hands& hands) {
    const Hand& hand = hands[aim_->hand];
    if (hand.aim && is_aimed_at(hand.hit.target)) {
        const Ray ray = xr::ray_of(*hand.aim);
        aim_->at = ray.origin + hand.hit.distance_m * ray.direction;
    }
    if (!aim_->at) return;
    if (const auto world_from_node = aimed_at(state, aim_->node, *aim_->at))
        editor::move_node(state.evaluated, *state.stage, aim_->node, *world_from_node);
}

editor::Editor::Operation LightHands::set_opening_of(const Held& held) {
    if (!held.has_opened) return {};
    return [node = held.node, degrees = held.opening->degrees](edit::Document& document) {
        return set_opening(document.file, node, degrees);
    };
}

void LightHands::release(HeadsetState& state) {
    const auto held = std::exchange(held_, std::nullopt);
    const auto aim = std::exchange(aim_, std::nullopt);
    if (held && held->node < state.stage->scene.nodes.size())
        move_node_to(state, held->node, held->grab.world_from_node(), set_opening_of(*held));
    if (aim && aim->at && aim->node < state.stage->scene.nodes.size()) aim_node_at(state, aim->node, *aim->at);
}

}  // namespace neuvv::headset
