#include "tools/headset/light_hands.h"

#include "base/error.h"
#include "edit/operations.h"
#include "tools/headset/arrange.h"
#include "tools/headset/markers.h"

namespace neuvv::headset {

namespace {

bool is_locked(HeadsetState& state, uint32_t node) {
    if (!edit::is_locked(state.editor.file(), node)) return false;
    state.editor.notify("it is locked: unlock it to move it", true);
    return true;
}

}  // namespace

void LightHands::press(HeadsetState& state, Hand& hand, int which) {
    const auto selected = selected_marker(state);
    using enum PointerHit::Target;
    if (hand.hit.target == kMarker) {
        state.editor.select(hand.hit.node);
        hand.vibrate(0.5);
    } else if (selected && (hand.hit.target == kPerformer || hand.hit.target == kFloor)) {
        if (!is_locked(state, *selected)) aim_ = Aim{which, *selected, {}};
    } else if (hand.aim) {
        hand.deselect_on_release = true;
    }
}

void LightHands::start_holding(HeadsetState& state, Hand& hand, int which) {
    if (!hand.aim || hand.hit.target != PointerHit::Target::kMarker || is_locked(state, hand.hit.node)) return;
    const uint32_t node = hand.hit.node;
    held_ = Held{which, node, xr::Grab(state.evaluated.pose.world_from_node[node], {.upright = false})};
    held_->grab.attach(which, *hand.aim, hand.hit.distance_m);
    state.editor.select(node);
    hand.vibrate(0.7);
}

void LightHands::update(HeadsetState& state, Hands& hands, double dt_s) {
    if (state.tool != HandTool::kLights) return release(state);
    for (int which = 0; which < xr::kHands; which++) {
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

void LightHands::show_held(HeadsetState& state, Hands& hands, double dt_s) {
    const Hand& hand = hands[held_->hand];
    if (hand.aim) held_->grab.move(held_->hand, *hand.aim);
    if (const double by_m = pushed_m(hand, dt_s); by_m != 0) held_->grab.push(held_->hand, by_m);
    editor::move_node(state.evaluated, *state.stage, held_->node, held_->grab.world_from_node());
}

void LightHands::show_aim(HeadsetState& state, const Hands& hands) {
    const Hand& hand = hands[aim_->hand];
    const bool hits =
        hand.hit.target == PointerHit::Target::kPerformer || hand.hit.target == PointerHit::Target::kFloor;
    if (hand.aim && hits) {
        const Ray ray = xr::ray_of(*hand.aim);
        aim_->at = ray.origin + hand.hit.distance_m * ray.direction;
    }
    if (!aim_->at) return;
    if (const auto world_from_node = aimed_at(state, aim_->node, *aim_->at))
        editor::move_node(state.evaluated, *state.stage, aim_->node, *world_from_node);
}

void LightHands::release(HeadsetState& state) {
    const auto held = std::exchange(held_, std::nullopt);
    const auto aim = std::exchange(aim_, std::nullopt);
    if (held && held->node < state.stage->scene.nodes.size())
        move_node_to(state, held->node, held->grab.world_from_node());
    if (aim && aim->at && aim->node < state.stage->scene.nodes.size()) aim_node_at(state, aim->node, *aim->at);
}

}  // namespace neuvv::headset
