#include "tools/headset/arrange.h"

#include <fmt/format.h>

#include <cmath>

#include "base/error.h"
#include "edit/operations.h"

namespace neuvv::headset {

namespace {

constexpr double kCopyDistance = 1.1;  // between middles, in widths of the performer

glm::dmat4 world_from_parent(const HeadsetState& state, uint32_t node) {
    const int32_t parent = state.stage->scene.nodes[node].parent;
    return parent < 0 ? glm::dmat4(1) : state.evaluated.pose.world_from_node[static_cast<size_t>(parent)];
}

// The width of what is solid of the selected performer, along its own X, in the units of the node's parent.
std::optional<double> width_of_selected(const HeadsetState& state) {
    const auto performer = state.selected_performer();
    if (!performer) return std::nullopt;
    const uint32_t node = state.stage->performers[*performer].node;
    const auto [low, high] = editor::box_of(state, *performer);
    const glm::dmat4 local = glm::inverse(world_from_parent(state, node)) * state.evaluated.pose.world_from_node[node];
    return (high.x - low.x) * glm::length(glm::dvec3(local[0]));
}

}  // namespace

void duplicate_selected(HeadsetState& state) {
    if (!state.editor.selected()) return state.editor.notify("point at a performer and select it first", true);
    const size_t before = state.editor.node_count();
    edit::CopySettings copies;
    if (const auto width = width_of_selected(state); width && *width > 0) copies.distance_m = kCopyDistance * *width;
    const bool done = state.editor.edit([&](edit::Document& document) {
        return edit::duplicate_node(document.file, *state.editor.selected(), copies);
    });
    if (done && state.editor.node_count() > before) state.editor.select(static_cast<uint32_t>(before));
}

void make_copies(HeadsetState& state) {
    if (!state.selected_performer()) return state.editor.notify("point at a performer and select it first", true);
    state.editor.edit([&](edit::Document& document) {
        return edit::duplicate_node(document.file, *state.editor.selected(), state.copies);
    });
}

std::vector<glm::dmat4> planned_copies(const HeadsetState& state) {
    if (state.is_behind() || !state.selected_performer()) return {};
    const uint32_t node = *state.editor.selected();
    std::vector<glm::dmat4> transforms = edit::copy_transforms(state.editor.file(), node, state.copies);
    for (glm::dmat4& transform : transforms) transform = world_from_parent(state, node) * transform;
    return transforms;
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
