#include "tools/headset/hands/hand_shapes.h"

#include <cmath>

#include "base/box.h"
#include "media/colour.h"
#include "tools/headset/draw/markers.h"
#include "tools/headset/state/arrange.h"

namespace neuvv::headset {

namespace {

constexpr glm::vec4 kBody{0.08f, 0.085f, 0.09f, 1}, kTrim{0.3f, 0.32f, 0.35f, 1}, kBlue{0.05f, 0.42f, 0.85f, 1},
    kWhite{0.9f, 0.9f, 0.9f, 0.8f}, kRay{0.5f, 0.75f, 1, 0.8f}, kFaint{0.5f, 0.75f, 1, 0}, kGreen{0.1f, 0.75f, 0.3f, 1},
    kRed{0.8f, 0.1f, 0.05f, 1}, kNoRegion{0, 0, 0, 0};
constexpr double kIdleRay_m = 1.2, kSelectedMargin = 0.006, kPicked_m = 0.025;

void draw_controller(xr::EyeShapes& shapes, const Hand& hand) {
    if (!hand.grip || hand.input.bare_hand) return;
    const glm::dmat4 grip = xr::matrix_of(*hand.grip);
    shapes.solid_box(grip, {-0.017, -0.02, -0.03}, {0.017, 0.015, 0.085}, kBody);
    shapes.solid_box(grip, {-0.024, 0.0, -0.075}, {0.024, 0.022, -0.03}, kTrim);
    const float pressed = static_cast<float>(std::clamp(hand.input.select, 0.0, 1.0));
    shapes.solid_box(grip, {-0.008, -0.02, -0.062}, {0.008, 0.0, -0.045},
                     glm::mix(kTrim, kBlue, hand.select.is_down() ? 1.0f : 0.5f * pressed));
}

// `set_counts`: whether the trigger does something where the ray meets the set or the floor.
void draw_ray(xr::EyeShapes& shapes, const Hand& hand, std::optional<double> grabbed_m, bool set_counts) {
    if (!hand.aim) return;
    using enum PointerHit::Target;
    const bool hits =
        hand.hit.target != kNothing && ((hand.hit.target != kFloor && hand.hit.target != kSet) || set_counts);
    const double distance_m = grabbed_m ? *grabbed_m : hits ? hand.hit.distance_m : kIdleRay_m;
    const Ray ray = xr::ray_of(*hand.aim);
    const glm::dvec3 end = ray.origin + distance_m * ray.direction;
    shapes.line(ray.origin, end, 0.003, kRay, hits || grabbed_m ? kRay : kFaint);
    if (hits || grabbed_m)
        shapes.ball(end, grabbed_m ? 0.014 : 0.008, grabbed_m ? kBlue : glm::vec4(0.9f, 0.9f, 0.9f, 1));
}

void draw_boxes(xr::EyeShapes& shapes, const HeadsetState& state, const Interaction& interaction) {
    const auto selected = state.selected_performer();
    for (const stage::EvaluatedPerformer& performer : state.evaluated.performers) {
        if (!performer.visible) continue;
        bool pointed_at = false;
        for (const Hand& hand : interaction.hands)
            pointed_at |=
                hand.hit.target == PointerHit::Target::kPerformer && hand.hit.performer == performer.performer;
        const bool is_selected = selected == performer.performer;
        if (!is_selected && !(pointed_at && state.tool == HandTool::kArrange)) continue;
        const auto [low, high] = editor::box_of(state, performer.performer);
        // A margin keeps the selection's edges off those of another box in the same place, but not below the floor.
        const double margin = is_selected ? kSelectedMargin : 0;
        shapes.box_edges(performer.world_from_performer, low - glm::dvec3(margin, 0, margin), high + margin,
                         is_selected ? 0.006 : 0.003, is_selected ? kBlue : kWhite);
    }
    const auto& region = interaction.painter.region();
    if (state.tool != HandTool::kRegion || !region) return;
    for (const stage::EvaluatedPerformer& performer : state.evaluated.performers)
        if (state.stage->performers[performer.performer].node == region->node)
            shapes.box_edges(performer.world_from_performer, region->low, region->high, 0.004, kGreen);
}

// Where copies would stand while the panel's page of copies is open: their boxes, with a mark at the feet in front.
void draw_planned_copies(xr::EyeShapes& shapes, const HeadsetState& state) {
    if (state.tool != HandTool::kArrange || state.page != PanelPage::kCopies || !state.panel_visible) return;
    const auto performer = state.selected_performer();
    if (!performer) return;
    const auto [low, high] = editor::box_of(state, *performer);
    const glm::dvec3 centre(0.5 * (low.x + high.x), low.y, 0.5 * (low.z + high.z)), front(centre.x, low.y, high.z);
    for (const auto& [world_from_copy, is_taken] : planned_copies(state)) {
        const glm::vec4 colour = is_taken ? kRed : kGreen;
        shapes.box_edges(world_from_copy, low, high, 0.004, colour);
        shapes.line(world_from_copy * glm::dvec4(centre, 1), world_from_copy * glm::dvec4(front, 1), 0.01, colour,
                    colour);
    }
}

glm::vec4 brush_colour(const HandBrush& brush, float alpha) {
    if (brush.mode == HandBrush::Mode::kErase) return {0.6f, 0.6f, 0.6f, alpha};
    return {media::linear_from_srgb(brush.colour), alpha};
}

// The colour under the ray, at the ray's end.
void draw_picked_colour(xr::EyeShapes& shapes, const Hand& hand) {
    if (!hand.hit.colour) return;
    const Ray ray = xr::ray_of(*hand.aim);
    shapes.ball(ray.origin + (hand.hit.distance_m - kPicked_m) * ray.direction, kPicked_m,
                glm::vec4(*hand.hit.colour, 1));
}

// The frame of the image that the next press would project, and a mark at its upper edge.
void draw_image_frame(xr::EyeShapes& shapes, const HeadsetState& state, const Hand& hand,
                      const Interaction& interaction) {
    const double half = state.brush.radius_m, up = half * interaction.painter.image_height(),
                 away = hand.hit.distance_m;
    const auto at = [&](double x, double y) { return *hand.aim * glm::dvec3(x, y, -away); };
    shapes.draw_on_top(true);
    shapes.path(std::array{at(-half, -up), at(half, -up), at(half, up), at(-half, up), at(-half, -up)}, 0.004, kGreen);
    shapes.line(at(0, up), at(0, 1.15 * up), 0.004, kGreen, kGreen);
    shapes.draw_on_top(false);
}

void draw_brush(xr::EyeShapes& shapes, const HeadsetState& state, const Interaction& interaction) {
    const Hand& hand = interaction.hands[xr::kRight];
    if (!paints(state.tool) || !hand.aim || hand.hit.target == PointerHit::Target::kPanel) return;
    if (state.picks_colour) return draw_picked_colour(shapes, hand);
    if (state.tool == HandTool::kRegion) {
        shapes.draw_on_top(true);  // the region's corner is visible inside a performer, too
        shapes.ball(HandPainter::tip_of(*hand.aim), 0.008, kGreen);
        return shapes.draw_on_top(false);
    }
    const auto at = HandPainter::brush_at(state, hand);
    if (!at) return;
    const glm::dvec3 tip = *at;
    if (state.brush.mode == HandBrush::Mode::kImage) return draw_image_frame(shapes, state, hand, interaction);
    // The brush is drawn twice: faintly on top of all, then with a depth test, so inside or behind a performer it is
    // faint.
    for (const bool on_top : {true, false}) {
        shapes.draw_on_top(on_top);
        const glm::vec4 colour = brush_colour(state.brush, on_top ? 0.15f : hand.select.is_down() ? 0.6f : 0.35f);
        const double radius = state.brush.radius_m;
        if (state.brush.tip == HandBrush::Tip::kBall)
            shapes.ball(tip, radius, colour);
        else
            shapes.solid_box(glm::translate(glm::dmat4(1), tip), glm::dvec3(-radius), glm::dvec3(radius), colour);
    }
}

// Where the teleport leads, and an arrow in the heading that the user will have there, where that changes.
void draw_arc(xr::EyeShapes& shapes, const xr::Arc* arc, std::optional<double> yaw_rad) {
    if (!arc) return;
    shapes.path(arc->points, 0.012, arc->landing ? kGreen : kRed);
    if (!arc->landing) return;
    const glm::dvec3 centre = *arc->landing + glm::dvec3(0, 0.01, 0);
    shapes.ring(centre, 0.22, 0.04, kGreen);
    if (!yaw_rad) return;
    const auto at = [&](double x, double z) { return centre + xr::turn_by(*yaw_rad) * glm::dvec3(x, 0, z); };
    shapes.path(std::array{at(0, 0.15), at(0, -0.5)}, 0.03, kGreen);
    shapes.path(std::array{at(-0.12, -0.36), at(0, -0.5), at(0.12, -0.36)}, 0.03, kGreen);
}

}  // namespace

namespace {

// Below what is solid of each performer; fainter the higher it floats.
void draw_contact_shadows(xr::EyeShapes& shapes, const HeadsetState& state) {
    constexpr double kWider = 1.25, kFades_m = 0.4;
    constexpr float kDarkness = 0.85f;
    for (const stage::EvaluatedPerformer& performer : state.evaluated.performers) {
        if (!performer.visible) continue;
        const auto [low, high] = editor::box_of(state, performer.performer);
        const glm::dmat4& world = performer.world_from_performer;
        const double above_m = std::abs(above_floor(world, low, high, state.floor_m));
        const auto alpha = static_cast<float>(kDarkness * performer.opacity * std::exp(-above_m / kFades_m));
        if (!(alpha > 0.01f)) continue;
        const glm::dvec3 size = high - low;
        glm::dvec3 centre = world * glm::dvec4(low + 0.5 * size, 1);
        centre.y = state.floor_m;
        const auto half = [&](int axis) {
            const glm::dvec3 along(world[axis].x, 0, world[axis].z);
            return 0.5 * kWider * size[axis] * along;
        };
        shapes.ellipse(centre, half(0), half(2), {0, 0, 0, alpha}, {0, 0, 0, 0});
    }
}

}  // namespace

void draw_floor(xr::EyeShapes& shapes, const HeadsetState& state) {
    constexpr int kLinesPerSide = 4;
    constexpr double kFloor_m = 6;
    constexpr glm::vec4 kLine{0.25f, 0.27f, 0.3f, 0.5f}, kFadedLine{0.25f, 0.27f, 0.3f, 0};
    constexpr glm::vec4 kFloor{0.06f, 0.063f, 0.07f, 0.9f}, kFloorRim{0.06f, 0.063f, 0.07f, 0};
    if (editor::has_set(*state.stage)) return;
    const glm::dvec3 centre(std::round(state.rig.position.x), state.floor_m, std::round(state.rig.position.z));
    shapes.ellipse({state.head.x, state.floor_m, state.head.z}, {kFloor_m, 0, 0}, {0, 0, kFloor_m}, kFloor, kFloorRim);
    draw_contact_shadows(shapes, state);
    for (int i = -kLinesPerSide; i <= kLinesPerSide; ++i)
        for (const glm::dvec3& along : {glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 1)}) {
            const glm::dvec3 beside(along.z, 0, along.x), at = centre + double(i) * beside;
            for (const double direction : {-1.0, 1.0})
                shapes.line(at, at + direction * kLinesPerSide * along, 0.008, i == 0 ? kLine : 0.7f * kLine,
                            kFadedLine);
        }
}

void draw_interaction(xr::EyeShapes& shapes, const HeadsetState& state, const Interaction& interaction) {
    draw_boxes(shapes, state, interaction);
    draw_planned_copies(shapes, state);
    draw_markers(shapes, state, interaction.hands);
    const bool aims_lights = state.tool == HandTool::kLights && selected_marker(state);
    for (int which = 0; which < xr::kHands; ++which) {
        const Hand& hand = interaction.hands[which];
        draw_controller(shapes, hand);
        const bool uses_ray = state.picks_colour || (state.tool == HandTool::kPaint && state.brush.uses_ray());
        const bool has_brush =
            which == xr::kRight && paints(state.tool) && !uses_ray && hand.hit.target != PointerHit::Target::kPanel;
        if (has_brush || hand.aiming_teleport) continue;
        std::optional<double> grabbed_m;
        if (interaction.grab.is_grabbing(which)) grabbed_m = interaction.grab.distance_m(which);
        if (interaction.lights.is_holding(which)) grabbed_m = interaction.lights.distance_m();
        draw_ray(shapes, hand, grabbed_m, aims_lights);
    }
    draw_brush(shapes, state, interaction);
    draw_arc(shapes, interaction.locomotion.arc(), interaction.locomotion.arc_yaw());
    if (interaction.panel) shapes.hole(interaction.panel->world_from_panel, interaction.panel->size_m);
}

void draw_joints(xr::EyeShapes& shapes, const xr::HandJoints& joints, const xr::Pose& world_from_tracking) {
    for (const xr::HandJoint& joint : joints)
        shapes.ball(world_from_tracking * joint.position, joint.radius_m, {0.75f, 0.6f, 0.5f, 1});
}

}  // namespace neuvv::headset
