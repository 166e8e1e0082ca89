#include "tools/headset/interaction.h"

#include <algorithm>
#include <cmath>

#include "edit/operations.h"
#include "xr/ray_hit.h"

namespace neuvv::headset {

namespace {

constexpr double kPanelAway_m = 0.75, kPanelBelow_m = 0.18, kPanelBeside_rad = 0.38, kFarthest_m = 30, kCall_s = 0.8;
constexpr double kSpeeds[] = {-2, -1, -0.5, -0.25, 0.25, 0.5, 1, 2, 4};

// Beside what the head looks at, where the right hand reaches it, upright, turned to it.
xr::Pose panel_before(const xr::Pose& world_head) {
    const glm::dquat turned = xr::turn_by(xr::yaw_of(world_head.rotation) + kPanelBeside_rad);
    return {world_head.position + turned * glm::dvec3(0, -kPanelBelow_m, -kPanelAway_m), turned};
}

// Above the wrist, tilted to who looks down at it.
xr::Pose panel_on(const xr::Pose& world_grip) {
    const xr::Pose above{{0, 0.16, 0.02}, glm::angleAxis(glm::radians(-50.0), glm::dvec3(1, 0, 0))};
    return world_grip * above;
}

size_t node_count(const OnStage& on) {
    return on.editor.node_count();
}

}  // namespace

void duplicate_selected(OnStage& on) {
    if (!on.editor.selected()) return on.editor.notify("point at a performer and select it first", true);
    const size_t before = node_count(on);
    edit::CopySettings copies;
    copies.distance_m = 0.8;
    const bool done = on.editor.edit(
        [&](edit::Document& document) { return edit::duplicate_node(document.file, *on.editor.selected(), copies); });
    if (done && node_count(on) > before) on.editor.select(static_cast<uint32_t>(before));
}

void delete_selected(OnStage& on) {
    if (!on.editor.selected()) return on.editor.notify("point at a performer and select it first", true);
    if (edit::is_locked(on.editor.file(), *on.editor.selected()))
        return on.editor.notify("it is locked: unlock it to delete it", true);
    if (on.editor.edit(
            [&](edit::Document& document) { return edit::remove_node(document.file, *on.editor.selected()); }))
        on.editor.select({});
}

void Interaction::update(OnStage& on, const xr::HandInputs& inputs, const xr::Pose& head, double dt_s) {
    place_hands(on, inputs, dt_s);
    place_panel(on, head);
    move_panel(on);
    point(on);
    remember_presses();
    press_buttons(on);
    if (!on.is_behind()) select(on);
    if (!on.is_behind()) holding.update(on, hands, dt_s);
    if (!on.is_behind()) brush.update(on, hands);
    if (!on.is_behind())
        for (Hand& hand : hands) hand.fresh = false;
    std::array<bool, xr::kHands> free{};
    for (int which = 0; which < xr::kHands; which++)
        free[which] = !holding.holds(which) && hands[which].at.what != PointedAt::What::kPanel;
    walking.update(on, hands, free, head, dt_s);
}

void Interaction::place_hands(const OnStage& on, const xr::HandInputs& inputs, double dt_s) {
    const xr::Pose world = xr::world_from_tracking(on.rig);
    for (int which = 0; which < xr::kHands; which++) {
        Hand& hand = hands[which];
        hand.input = inputs[which];
        hand.pulse = 0;
        hand.aim.reset();
        hand.grip.reset();
        if (hand.input.aim && xr::is_valid(*hand.input.aim)) hand.aim = world * *hand.input.aim;
        if (hand.input.grip && xr::is_valid(*hand.input.grip)) hand.grip = world * *hand.input.grip;
        hand.select.update(hand.input.select);
        hand.grab.update(hand.input.grab);
        hand.flick.update(hand.input.stick);
        hand.selecting_s = hand.select.is_down() ? hand.selecting_s + dt_s : 0;
    }
}

void Interaction::place_panel(OnStage& on, const xr::Pose& head) {
    Hand& left = hands[xr::kLeft];
    const bool calls = left.input.lacks_menu && left.selecting_s > kCall_s && !left.held_long &&
                       (left.pressed.what == PointedAt::What::kNothing || left.pressed.what == PointedAt::What::kFloor);
    if (calls) left.held_long = true;
    if (left.input.menu || hands[xr::kRight].input.menu || calls) on.panel_shown = !on.panel_shown;
    if (!on.panel_shown) {
        panel.reset();
        panel_was_shown_ = false;
        return;
    }
    if (!panel) panel.emplace();
    if (on.panel_on_wrist) {
        panel->size_m = kWristPanel_m;
        const auto& wrist = left.grip ? left.grip : left.aim;
        if (!wrist && !panel_was_shown_) return panel.reset();
        if (wrist) panel->world = panel_on(*wrist);
    } else if (!panel_was_shown_ || panel_was_on_wrist_) {
        panel->size_m = kPanel_m;
        panel->world = panel_before(xr::world_from_tracking(on.rig) * head);
    }
    panel_was_shown_ = true;
    panel_was_on_wrist_ = on.panel_on_wrist;
}

// A grip on the panel holds it as it is.
void Interaction::move_panel(const OnStage& on) {
    if (held_panel_ && !hands[held_panel_->first].grab.is_down()) held_panel_.reset();
    if (!panel || on.panel_on_wrist) return held_panel_.reset();
    for (int which = 0; which < xr::kHands; which++) {
        Hand& hand = hands[which];
        if (held_panel_ || !hand.aim || !hand.grab.pressed()) continue;
        if (!xr::rectangle_hit(xr::ray_of(*hand.aim), panel->world, panel->size_m)) continue;
        held_panel_.emplace(which, xr::inverse(*hand.aim) * panel->world);
        hand.feel(0.4);
    }
    if (held_panel_ && hands[held_panel_->first].aim)
        panel->world = *hands[held_panel_->first].aim * held_panel_->second;
}

void Interaction::point(const OnStage& on) {
    for (int which = 0; which < xr::kHands; which++) {
        Hand& hand = hands[which];
        hand.at = {};
        if (!hand.aim) continue;
        const Ray ray = xr::ray_of(*hand.aim);
        if (panel && !(on.panel_on_wrist && which == xr::kLeft))
            if (const auto hit = xr::rectangle_hit(ray, panel->world, panel->size_m)) {
                hand.at = {PointedAt::What::kPanel, hit->distance_m, hit->uv};
                continue;
            }
        double nearest = kFarthest_m;
        for (const stage::EvaluatedPerformer& performer : on.evaluated.performers) {
            if (!performer.visible) continue;
            const auto [low, high] = editor::box_of(on, performer.performer);
            const auto metres = box_hit(ray, performer.world_from_performer, low, high);
            if (!metres || *metres >= nearest) continue;
            nearest = *metres;
            hand.at = {PointedAt::What::kPerformer, nearest, {}, performer.performer};
        }
        const double down = -ray.direction.y, to_floor = (ray.origin.y - on.floor_m) / down;
        if (hand.at.what == PointedAt::What::kNothing && down > 1e-3 && to_floor > 0 && to_floor < kFarthest_m)
            hand.at = {PointedAt::What::kFloor, to_floor};
    }
}

// What a press begins on it belongs to until it ends, wherever the ray goes meanwhile.
void Interaction::remember_presses() {
    for (Hand& hand : hands) {
        if (hand.select.pressed()) {
            hand.pressed = hand.at;
            hand.fresh = true;
            hand.held_long = hand.deselects = false;
        }
        if (!hand.select.is_down()) hand.pressed = {};
        const bool on_panel = hand.pressed.what == PointedAt::What::kPanel && hand.at.what == PointedAt::What::kPanel;
        if (on_panel) hand.pressed = hand.at;
    }
}

void Interaction::press_buttons(OnStage& on) {
    for (Hand& hand : hands) {
        if (hand.input.play) on.clock.play_or_pause();
        if (!hand.input.undo && !hand.input.duplicate) continue;
        hand.feel(0.4);
        holding.put_down(on);
        brush.end_stroke(on);
        if (brush.busy()) {
            on.editor.notify("the stroke is still being laid", true);
            continue;
        }
        if (hand.input.undo) on.editor.undo();
        if (hand.input.duplicate) duplicate_selected(on);
    }
    if (!holding.holds(xr::kRight)) change_speed(on, hands[xr::kRight]);
    if (!holding.holds(xr::kLeft)) step_through(on, hands[xr::kLeft]);
}

// The right stick up and down: how fast it plays, backwards below the slowest.
void Interaction::change_speed(OnStage& on, Hand& hand) {
    const int steps = hand.flick.went_up() - hand.flick.went_down();
    if (steps == 0 || hand.at.what == PointedAt::What::kPanel) return;
    const auto now = std::min_element(std::begin(kSpeeds), std::end(kSpeeds), [&](double a, double b) {
        return std::abs(a - on.clock.speed) < std::abs(b - on.clock.speed);
    });
    const auto last = static_cast<std::ptrdiff_t>(std::size(kSpeeds)) - 1;
    on.clock.speed = kSpeeds[std::clamp<std::ptrdiff_t>(now - std::begin(kSpeeds) + steps, 0, last)];
    hand.feel(0.15);
}

// The left stick to the sides: an image forwards or backwards; a second while it plays.
void Interaction::step_through(OnStage& on, Hand& hand) {
    const int steps = hand.flick.went_right() - hand.flick.went_left();
    if (steps == 0 || hand.at.what == PointedAt::What::kPanel || on.comfort.smooth_walk) return;
    if (on.clock.playing)
        on.clock.scrub(std::clamp(on.clock.time_s() + steps, on.clock.in_s(), on.clock.last_s()));
    else
        on.clock.step(steps);
    hand.feel(0.15);
}

void Interaction::select(OnStage& on) {
    for (int which = 0; which < xr::kHands; which++) {
        Hand& hand = hands[which];
        if (!hand.select.is_down() && std::exchange(hand.deselects, false) && !hand.held_long) on.editor.select({});
        if (!hand.fresh) continue;
        if (hand.at.what == PointedAt::What::kPanel) {
            hand.fresh = false;
            panel_hand_ = which;
            hand.feel(0.2);
            continue;
        }
        if (on.tool != HandTool::kArrange || holding.any()) continue;
        hand.fresh = false;
        if (hand.at.what == PointedAt::What::kPerformer) {
            on.editor.select(on.stage->performers[hand.at.performer].node);
            hand.feel(0.5);
        } else if (hand.aim) {
            hand.deselects = true;
        }
    }
}

PanelPointer Interaction::panel_pointer() const {
    PanelPointer pointer;
    constexpr auto kPanel = PointedAt::What::kPanel;
    int which = panel_hand_;
    if (hands[which].at.what != kPanel && hands[which].pressed.what != kPanel) which = 1 - which;
    const Hand& hand = hands[which];
    pointer.pressed = hand.pressed.what == kPanel;
    if (pointer.pressed)
        pointer.at = hand.pressed.on_panel;
    else if (hand.at.what == kPanel && !hand.select.is_down())
        pointer.at = hand.at.on_panel;
    if (pointer.at && std::abs(hand.input.stick.y) > 0.3) pointer.wheel = hand.input.stick.y;
    return pointer;
}

}  // namespace neuvv::headset
