#include "tools/viewer/panels/node_actions.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <fmt/format.h>

#include "edit/light_values.h"

namespace neuvv::viewer {

namespace {

// Selects the first node that the edit added.
void add(Viewer& viewer, const editor::Editor::Operation& operation) {
    const size_t before = viewer.editor.node_count();
    if (viewer.editor.edit(operation) && viewer.editor.node_count() > before)
        viewer.editor.select(static_cast<uint32_t>(before));
}

}  // namespace

void follow_document(Viewer& viewer) {
    if (!viewer.editor.is_open() || viewer.stage_tree.id == viewer.editor.id()) return;
    viewer.stage_tree.id = viewer.editor.id();
    viewer.stage_tree.rows = stage_rows(viewer.editor.file());
    viewer.stage_tree.renaming.reset();
}

void begin_renaming(Viewer& viewer, uint32_t node) {
    const std::vector<StageRow>& rows = viewer.stage_tree.rows;
    const auto row = row_of(rows, node);
    if (!row) return;
    open_above(rows, *row, viewer.stage_tree.closed);
    viewer.stage_tree.renaming = node;
    viewer.stage_tree.typed = rows[*row].title;
    viewer.stage_tree.begin_typing = true;
}

void duplicate_once(Viewer& viewer, uint32_t node) {
    add(viewer,
        [&](edit::Document& document) { return edit::duplicate_node(document.file, node, edit::CopySettings{}); });
}

void delete_node(Viewer& viewer, uint32_t node) {
    const auto row = row_of(viewer.stage_tree.rows, node);
    if (!row) return;
    if (const auto locked = locked_within(viewer.stage_tree.rows, *row)) {
        viewer.editor.notify(fmt::format("\"{}\" is locked: unlock it to delete it", *locked), true);
        return;
    }
    // Another node would have its number.
    if (viewer.editor.edit([&](edit::Document& document) { return edit::remove_node(document.file, node); }))
        viewer.editor.select({});
}

// A lamp stands where one hangs it in front of who is looked at: aside, above, and on the viewer's side.
void add_light_in_view(Viewer& viewer, stage::GltfLightKind kind) {
    const Eye& eye = viewer.eye;
    const glm::dmat4 seen = world_from_eye(eye);
    const glm::dvec3 right(seen[0]);
    const glm::dvec3 back = glm::dvec3(std::sin(eye.yaw), 0, std::cos(eye.yaw));
    glm::dvec3 aim = eye.pivot;
    if (viewer.stage && !viewer.stage->performers.empty()) {
        const auto [low, high] = stage::performers_box(*viewer.stage, viewer.evaluated);
        aim = 0.5 * (low + high);
    }
    edit::Placement placement;
    placement.at = aim - 1.5 * right + glm::dvec3(0, 2.5, 0) + 1.5 * back;
    placement.aim = aim;
    edit::LightEdit edit;
    edit.kind = edit::kLightKindNames[static_cast<size_t>(kind)];
    edit.intensity = edit::usual_intensity(kind);
    if (kind == stage::GltfLightKind::kSpot) {
        edit.outer_cone_deg = 30;
        edit.inner_cone_deg = edit::inner_cone_for(0.5, *edit.outer_cone_deg);
    }
    const char* const name = kind == stage::GltfLightKind::kSpot    ? "spot"
                             : kind == stage::GltfLightKind::kPoint ? "lamp"
                                                                    : "sun";
    add(viewer, [&](edit::Document& document) { return edit::add_light(document.file, name, edit, placement); });
}

void add_camera_in_view(Viewer& viewer) {
    add(viewer, [&](edit::Document& document) {
        return edit::add_camera(document.file, "camera", viewer.eye.angle_y, world_from_eye(viewer.eye));
    });
}

void take_node_keys(Viewer& viewer) {
    const auto node = viewer.editor.selected();
    if (!node || viewer.holds_handle) return;
    for (const ui::KeyPress& press : viewer.window.presses()) {
        if (press.alt || press.shift || press.repeat) continue;
        if (press.control && press.key == GLFW_KEY_D) duplicate_once(viewer, *node);
        if (press.control) continue;
        if (press.key == GLFW_KEY_H)
            viewer.editor.edit(
                [&](edit::Document& d) { return edit::show_node(d.file, *node, !edit::is_shown(d.file, *node)); });
        if (press.key == GLFW_KEY_F2) begin_renaming(viewer, *node);
        if (press.key == GLFW_KEY_DELETE) {
            delete_node(viewer, *node);
            return;
        }
    }
}

}  // namespace neuvv::viewer
