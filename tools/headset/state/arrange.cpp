#include "tools/headset/state/arrange.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "edit/operations.h"
#include "tools/headset/state/panel_placement.h"

namespace neuvv::headset {

glm::dmat4 world_from_parent(const HeadsetState& state, uint32_t node) {
    const int32_t parent = state.stage->scene.nodes[node].parent;
    return parent < 0 ? glm::dmat4(1) : state.evaluated.pose.world_from_node[static_cast<size_t>(parent)];
}

namespace {

constexpr double kCopyDistance = 1.1;  // between centres, in widths of the performer
constexpr int kMostPlaces = 64;        // of a row, to either side, that are looked at
// The share of a box along each axis in which nobody else may be: of a copy beside somebody, and of those whose
// distance the user has chosen.
constexpr double kClear = 0.95, kOverlapping = 0.5;

// The width of what is solid of the selected performer, along its own X, in the units of the node's parent.
std::optional<double> width_of_selected(const HeadsetState& state) {
    const auto performer = state.selected_performer();
    if (!performer) return std::nullopt;
    const uint32_t node = state.stage->performers[*performer].node;
    const auto [low, high] = editor::box_of(state, *performer);
    const glm::dmat4 local = glm::inverse(world_from_parent(state, node)) * state.evaluated.pose.world_from_node[node];
    return (high.x - low.x) * glm::length(glm::dvec3(local[0]));
}

// Whether a part of the first box's centre lies in the centre of the second; `share` is that of each axis that counts.
bool reaches_into(const PlacedBox& one, const PlacedBox& other, double share) {
    constexpr int kPoints = 4;  // along each axis, less one
    const glm::dmat4 other_from_one = glm::inverse(other.world_from_box) * one.world_from_box;
    const glm::dvec3 centre = 0.5 * (one.low + one.high), half = 0.5 * share * (one.high - one.low);
    const glm::dvec3 of_other = 0.5 * (other.low + other.high), other_half = 0.5 * share * (other.high - other.low);
    for (int i = 0; i < (kPoints + 1) * (kPoints + 1) * (kPoints + 1); ++i) {
        const glm::dvec3 at(i % (kPoints + 1), i / (kPoints + 1) % (kPoints + 1), i / (kPoints + 1) / (kPoints + 1));
        const glm::dvec3 point = centre + half * (2.0 * at / double{kPoints} - 1.0);
        const glm::dvec3 away = glm::abs(glm::dvec3(other_from_one * glm::dvec4(point, 1)) - of_other);
        if (glm::all(glm::lessThanEqual(away, other_half))) return true;
    }
    return false;
}

// Whether a performer of the stage stands where a box is. `except` does not count.
bool is_taken(const HeadsetState& state, const PlacedBox& box, double share, std::optional<uint32_t> except = {}) {
    for (const stage::EvaluatedPerformer& performer : state.evaluated.performers) {
        if (performer.performer == except) continue;
        const auto [low, high] = editor::box_of(state, performer.performer);
        const PlacedBox theirs{performer.world_from_performer, low, high};
        if (reaches_into(box, theirs, share) || reaches_into(theirs, box, share)) return true;
    }
    return false;
}

// The distance along the row at which a copy of the selected performer stands beside it and all others.
std::optional<double> free_distance_m(const HeadsetState& state) {
    const auto width = width_of_selected(state);
    if (!width || !(*width > 0)) return std::nullopt;
    const auto performer = state.selected_performer();
    const auto [low, high] = editor::box_of(state, *performer);
    const glm::dmat3 parent(world_from_parent(state, state.stage->performers[*performer].node));
    for (const stage::EvaluatedPerformer& one : state.evaluated.performers)
        for (int place = 1; one.performer == *performer && place <= kMostPlaces; ++place)
            for (const double side : {1.0, -1.0}) {
                const double distance_m = side * place * kCopyDistance * *width;
                PlacedBox box{one.world_from_performer, low, high};
                box.world_from_box[3] += glm::dvec4(parent * glm::dvec3(distance_m, 0, 0), 0);
                if (!is_taken(state, box, kClear)) return distance_m;
            }
    return kCopyDistance * *width;
}

}  // namespace

double free_shift_m(const HeadsetState& state, uint32_t performer, const glm::dmat4& world_from_performer,
                    const glm::dvec3& along) {
    const auto [low, high] = editor::box_of(state, performer);
    const double step_m = kCopyDistance * (high.x - low.x) * glm::length(glm::dvec3(world_from_performer[0]));
    for (int place = 0; step_m > 0 && place <= kMostPlaces; ++place)
        for (const double side : {1.0, -1.0}) {
            PlacedBox box{world_from_performer, low, high};
            box.world_from_box[3] += glm::dvec4(side * place * step_m * along, 0);
            if (!is_taken(state, box, kClear, performer)) return side * place * step_m;
        }
    return 0;
}

void duplicate_selected(HeadsetState& state) {
    if (!state.editor.selected()) return state.editor.notify("point at a performer and select it first", true);
    const size_t before = state.editor.node_count();
    edit::CopySettings copies;
    copies.distance_m = free_distance_m(state).value_or(copies.distance_m);
    const bool done = state.editor.edit([&](edit::Document& document) {
        return edit::duplicate_node(document.file, *state.editor.selected(), copies);
    });
    if (done && state.editor.node_count() > before) state.editor.select(static_cast<uint32_t>(before));
}

void make_copies(HeadsetState& state) {
    if (!state.selected_performer()) return state.editor.notify("point at a performer and select it first", true);
    const std::vector<PlannedCopy> planned = planned_copies(state);
    if (std::ranges::any_of(planned, [](const PlannedCopy& copy) { return copy.is_taken; }))
        return state.editor.notify("somebody stands in a red box: choose another distance or number", true);
    state.editor.edit([&](edit::Document& document) {
        return edit::duplicate_node(document.file, *state.editor.selected(), state.copies);
    });
}

std::vector<PlannedCopy> planned_copies(const HeadsetState& state) {
    const auto performer = state.selected_performer();
    if (state.is_behind() || !performer) return {};
    const uint32_t node = *state.editor.selected();
    const auto [low, high] = editor::box_of(state, *performer);
    std::vector<PlannedCopy> planned;
    for (const glm::dmat4& transform : edit::copy_transforms(state.editor.file(), node, state.copies)) {
        const glm::dmat4 world_from_copy = world_from_parent(state, node) * transform;
        planned.push_back({world_from_copy, is_taken(state, {world_from_copy, low, high}, kOverlapping, performer)});
    }
    return planned;
}

void delete_selected(HeadsetState& state) {
    if (!state.editor.selected()) return state.editor.notify("point at a performer and select it first", true);
    if (edit::is_locked(state.editor.file(), *state.editor.selected()))
        return state.editor.notify("it is locked: unlock it to delete it", true);
    if (state.editor.edit(
            [&](edit::Document& document) { return edit::remove_node(document.file, *state.editor.selected()); }))
        state.editor.select({});
}

void put_selected_on_floor(HeadsetState& state) {
    const auto performer = state.selected_performer();
    if (!performer) return;
    const uint32_t node = state.stage->performers[*performer].node;
    const auto [low, high] = editor::box_of(state, *performer);
    const glm::dmat4& world_from_node = state.evaluated.pose.world_from_node[node];
    const double above = above_floor(world_from_node, low, high, state.floor_m);
    if (std::abs(above) > kFloorReach_m)
        return state.editor.notify(fmt::format("its feet are {:.1f} m {} the floor: move it nearer first",
                                               std::abs(above), above > 0 ? "above" : "below"),
                                   true);
    move_node_to(state, node, on_floor(world_from_node, low, high, state.floor_m));
}

void move_node_to(HeadsetState& state, uint32_t node, const glm::dmat4& world_from_node,
                  const editor::Editor::Operation& more) {
    edit::Placement placement;
    placement.to = glm::inverse(world_from_parent(state, node)) * world_from_node;
    state.editor.edit([&](edit::Document& document) {
        std::string text = edit::place_node(document.file, node, placement);
        return more ? more(document) : text;
    });
}

void aim_node_at(HeadsetState& state, uint32_t node, const glm::dvec3& at) {
    edit::Placement placement;
    placement.aim = glm::dvec3(glm::inverse(world_from_parent(state, node)) * glm::dvec4(at, 1));
    state.editor.edit([&](edit::Document& document) { return edit::place_node(document.file, node, placement); });
}

std::optional<glm::dmat4> aimed_at(const HeadsetState& state, uint32_t node, const glm::dvec3& at) {
    const glm::dmat4 parent = world_from_parent(state, node);
    const glm::dvec3 target(glm::inverse(parent) * glm::dvec4(at, 1));
    stage::StageFile file = state.editor.file();
    edit::Placement placement;
    placement.aim = target;
    try {
        edit::place_node(file, node, placement);
    } catch (const InputError&) {
        return std::nullopt;
    }
    const edit::NodeTransform local = edit::transform_of(file, node);
    return parent * glm::translate(glm::dmat4(1), local.translation) * glm::mat4_cast(local.rotation) *
           glm::scale(glm::dmat4(1), local.scale);
}

}  // namespace neuvv::headset
