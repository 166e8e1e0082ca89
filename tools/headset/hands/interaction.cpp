#include "tools/headset/hands/interaction.h"

#include <algorithm>
#include <cmath>

#include "tools/headset/state/arrange.h"
#include "tools/headset/state/performer_edits.h"
#include "xr/ray_hit.h"

namespace neuvv::headset {

namespace {

constexpr double kPanelPress_s = 0.8;
constexpr double kSpeeds[] = {-2, -1, -0.5, -0.25, 0.25, 0.5, 1, 2, 4};

// What the panel is about: the trainer, else the selected performer, where there is one.
std::optional<PlacedBox> box_of_subject(const HeadsetState& state) {
    const auto subject = state.trainer ? state.trainer : state.selected_performer();
    for (const stage::EvaluatedPerformer& performer : state.evaluated.performers) {
        if (subject != performer.performer || !performer.visible) continue;
        const auto [low, high] = editor::box_of(state, performer.performer);
        return PlacedBox{performer.world_from_performer, low, high};
    }
    return std::nullopt;
}

// Above the wrist, tilted towards a user who looks down at it.
xr::Pose panel_on(const xr::Pose& world_grip) {
    const xr::Pose above{{0, 0.19, 0.02}, glm::angleAxis(glm::radians(-50.0), glm::dvec3(1, 0, 0))};
    return world_grip * above;
}

}  // namespace

void Interaction::update(HeadsetState& state, const xr::HandInputs& inputs, const xr::Pose& head, double dt_s,
                         const FindSurfaces& find_surfaces) {
    state.head = xr::world_from_tracking(state.rig) * head.position;
    update_hands(state, inputs, dt_s);
    update_panel(state, head);
    move_panel(state);
    land_new_performer(state, is_holding() || painter.is_busy() || state.slider_edits);
    const bool meets_set = state.tool == HandTool::kLights && !state.shows_room;
    if (meets_set) set_.follow(state.stage->scene, state.evaluated.pose);
    point(hands, state, panel, find_surfaces, meets_set ? &set_ : nullptr);
    track_presses();
    handle_buttons(state);
    if (!state.is_behind()) select(state);
    if (!state.is_behind()) grab.update(state, hands, dt_s);
    if (!state.is_behind()) lights.update(state, hands, dt_s);
    for (int which = 0; which < xr::kHands; ++which)
        used_buttons[which].grab |= grab.is_grabbing(which) || lights.is_holding(which);
    if (!state.is_behind()) painter.update(state, hands);
    if (!state.is_behind())
        for (Hand& hand : hands) hand.press_pending = false;
    std::array<bool, xr::kHands> stick_free{};
    for (int which = 0; which < xr::kHands; ++which)
        stick_free[which] = !grab.is_grabbing(which) && !lights.is_holding(which) &&
                            hands[which].hit.target != PointerHit::Target::kPanel;
    locomotion.update(state, hands, stick_free, head, dt_s);
}

void Interaction::update_hands(const HeadsetState& state, const xr::HandInputs& inputs, double dt_s) {
    const xr::Pose world = xr::world_from_tracking(state.rig);
    for (int which = 0; which < xr::kHands; ++which) {
        Hand& hand = hands[which];
        hand.input = inputs[state.hand_of(which)];
        note_used_buttons(which);
        hand.vibration = 0;
        hand.aim.reset();
        hand.grip.reset();
        if (hand.input.aim && xr::is_valid(*hand.input.aim)) hand.aim = world * *hand.input.aim;
        if (hand.input.grip && xr::is_valid(*hand.input.grip)) hand.grip = world * *hand.input.grip;
        hand.select.update(hand.input.select);
        hand.grab.update(hand.input.grab);
        hand.flick.update(hand.input.stick);
        hand.select_down_s = hand.select.is_down() ? hand.select_down_s + dt_s : 0;
    }
}

void Interaction::note_used_buttons(int which) {
    const xr::HandInput& input = hands[which].input;
    UsedButtons& used = used_buttons[which];
    used.select |= hands[which].select.is_down();
    used.grab |= hands[which].grab.is_down();
    used.stick |= glm::length(input.stick) > 0.5;
    used.menu |= input.menu;
    used.play |= input.play;
    used.undo |= input.undo;
    used.duplicate |= input.duplicate;
}

void Interaction::update_panel(HeadsetState& state, const xr::Pose& head) {
    Hand& left = hands[xr::kLeft];
    const bool long_press_on_nothing =
        left.input.lacks_menu && left.select_down_s > kPanelPress_s && !left.long_press &&
        (left.pressed_on.target == PointerHit::Target::kNothing || left.pressed_on.target == PointerHit::Target::kSet ||
         left.pressed_on.target == PointerHit::Target::kFloor);
    if (long_press_on_nothing) left.long_press = used_buttons[xr::kLeft].menu = true;
    if (left.input.menu || hands[xr::kRight].input.menu || long_press_on_nothing)
        state.panel_visible = !state.panel_visible;
    if (!state.panel_visible) {
        panel.reset();
        if (std::exchange(panel_was_visible_, false)) state.release_slider();
        return;
    }
    if (!panel) panel.emplace();
    if (state.panel_on_wrist) {
        panel->size_m = kWristPanel_m;
        const auto& wrist = left.grip ? left.grip : left.aim;
        if (!wrist && !panel_was_visible_) return panel.reset();
        if (wrist) panel->world_from_panel = panel_on(*wrist);
    } else if (!panel_was_visible_ || panel_was_on_wrist_) {
        panel = panel_in_view(xr::world_from_tracking(state.rig) * head, box_of_subject(state), state.left_handed,
                              state.trainer ? kTrainerAside_rad : kPanelAside_rad);
    }
    panel_was_visible_ = true;
    panel_was_on_wrist_ = state.panel_on_wrist;
}

// A hand whose grab button is pressed while its ray hits the panel moves and turns the panel.
void Interaction::move_panel(const HeadsetState& state) {
    if (panel_grab_ && !hands[panel_grab_->hand].grab.is_down()) panel_grab_.reset();
    if (!panel || state.panel_on_wrist) return panel_grab_.reset();
    for (int which = 0; which < xr::kHands; ++which) {
        Hand& hand = hands[which];
        if (panel_grab_ || !hand.aim || !hand.grab.pressed()) continue;
        if (!xr::rectangle_hit(xr::ray_of(*hand.aim), panel->world_from_panel, panel->size_m)) continue;
        panel_grab_ = PanelGrab{which, xr::inverse(*hand.aim) * panel->world_from_panel};
        hand.vibrate(0.4);
    }
    if (panel_grab_ && hands[panel_grab_->hand].aim)
        panel->world_from_panel = *hands[panel_grab_->hand].aim * panel_grab_->hand_from_panel;
}

void Interaction::release_all(HeadsetState& state) {
    grab.release(state);
    lights.release(state);
    painter.end_stroke(state);
    state.release_slider();
}

void Interaction::user_was_moved(HeadsetState& state) {
    release_all(state);
    panel_grab_.reset();
    panel_was_visible_ = false;
}

// A press belongs to what the ray hit when it began, wherever the ray moves meanwhile.
void Interaction::track_presses() {
    for (Hand& hand : hands) {
        if (hand.select.pressed()) {
            hand.pressed_on = hand.hit;
            hand.press_pending = true;
            hand.long_press = hand.deselect_on_release = false;
        }
        if (!hand.select.is_down()) hand.pressed_on = {};
        const bool stays_on_panel =
            hand.pressed_on.target == PointerHit::Target::kPanel && hand.hit.target == PointerHit::Target::kPanel;
        if (stays_on_panel) hand.pressed_on = hand.hit;
    }
}

void Interaction::handle_buttons(HeadsetState& state) {
    for (Hand& hand : hands) {
        if (hand.input.play) {
            state.clock.play_or_pause();
            hand.vibrate(0.4);
        }
        if (!hand.input.undo && !hand.input.duplicate) continue;
        release_all(state);
        if (painter.is_busy()) {
            state.editor.notify("the stroke is still being laid", true);
            continue;
        }
        if (hand.input.undo && !state.editor.history().next_undo()) {
            state.editor.notify("nothing to undo", true);
            continue;
        }
        hand.vibrate(0.4);
        if (hand.input.undo) state.editor.undo();
        if (hand.input.duplicate) duplicate_selected(state);
    }
    if (!grab.is_grabbing(xr::kRight) && !lights.is_holding(xr::kRight)) change_speed(state, hands[xr::kRight]);
    if (!grab.is_grabbing(xr::kLeft) && !lights.is_holding(xr::kLeft)) step_through(state, hands[xr::kLeft]);
}

// Right stick up and down: the next speed of kSpeeds; below the slowest one, the stage plays backwards.
void Interaction::change_speed(HeadsetState& state, Hand& hand) {
    const int steps = hand.flick.went_up() - hand.flick.went_down();
    if (steps == 0 || hand.hit.target == PointerHit::Target::kPanel) return;
    const auto now = std::min_element(std::begin(kSpeeds), std::end(kSpeeds), [&](double a, double b) {
        return std::abs(a - state.clock.speed) < std::abs(b - state.clock.speed);
    });
    const auto last = static_cast<std::ptrdiff_t>(std::size(kSpeeds)) - 1;
    state.clock.speed = kSpeeds[std::clamp<std::ptrdiff_t>(now - std::begin(kSpeeds) + steps, 0, last)];
    hand.vibrate(0.15);
}

// Left stick to the sides: a frame forwards or backwards; while the stage plays, a second.
void Interaction::step_through(HeadsetState& state, Hand& hand) {
    const int steps = hand.flick.went_right() - hand.flick.went_left();
    if (steps == 0 || hand.hit.target == PointerHit::Target::kPanel || state.comfort.smooth_walk) return;
    if (hand.aiming_teleport) return;  // the stick says where the user will look
    if (state.clock.playing)
        state.clock.scrub(std::clamp(state.clock.time_s() + steps, state.clock.in_s(), state.clock.last_s()));
    else
        state.clock.step(steps);
    hand.vibrate(0.15);
}

void Interaction::select(HeadsetState& state) {
    for (int which = 0; which < xr::kHands; ++which) {
        Hand& hand = hands[which];
        if (!hand.select.is_down() && std::exchange(hand.deselect_on_release, false) && !hand.long_press)
            state.editor.select({});
        if (!hand.press_pending) continue;
        if (hand.hit.target == PointerHit::Target::kPanel) {
            hand.press_pending = false;
            pointer_hand_ = which;
            hand.vibrate(0.2);
            continue;
        }
        if (state.tool != HandTool::kArrange || grab.is_active()) continue;
        hand.press_pending = false;
        if (hand.hit.target == PointerHit::Target::kPerformer) {
            state.editor.select(state.stage->performers[hand.hit.performer].node);
            hand.vibrate(0.5);
        } else if (hand.aim) {
            hand.deselect_on_release = true;
        }
    }
}

PanelPointer Interaction::panel_pointer() const {
    PanelPointer pointer;
    constexpr auto kPanel = PointerHit::Target::kPanel;
    int which = pointer_hand_;
    if (hands[which].hit.target != kPanel && hands[which].pressed_on.target != kPanel) which = 1 - which;
    const Hand& hand = hands[which];
    pointer.pressed = hand.pressed_on.target == kPanel;
    if (pointer.pressed)
        pointer.uv = hand.pressed_on.panel_uv;
    else if (hand.hit.target == kPanel && !hand.select.is_down())
        pointer.uv = hand.hit.panel_uv;
    if (pointer.uv && std::abs(hand.input.stick.y) > 0.3) pointer.wheel = hand.input.stick.y;
    return pointer;
}

}  // namespace neuvv::headset
