#include "tools/viewer/panels/stage_tree.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#include <fmt/format.h>

#include "edit/light_values.h"

namespace neuvv::viewer {

namespace {

// Selects the first node that the edit added.
void add(Context& context, const editor::Editor::Operation& operation) {
    const size_t before = context.editor.node_count();
    if (context.editor.edit(operation) && context.editor.node_count() > before)
        context.editor.select(static_cast<uint32_t>(before));
}

}  // namespace

void follow_document(const Context& context, StageTree& tree) {
    if (!context.editor.is_open() || tree.id == context.editor.id()) return;
    tree.id = context.editor.id();
    tree.rows = stage_rows(context.editor.file());
    tree.renaming.reset();
}

void begin_renaming(StageTree& tree, uint32_t node) {
    const std::vector<StageRow>& rows = tree.rows;
    const auto row = row_of(rows, node);
    if (!row) return;
    open_ancestors(rows, *row, tree.closed);
    tree.renaming = node;
    tree.typed = rows[*row].title;
    tree.begin_typing = true;
}

void duplicate_once(Context& context, uint32_t node) {
    add(context,
        [&](edit::Document& document) { return edit::duplicate_node(document.file, node, edit::CopySettings{}); });
}

void delete_node(Context& context, const StageTree& tree, uint32_t node) {
    const auto row = row_of(tree.rows, node);
    if (!row) return;
    if (const auto locked = locked_within(tree.rows, *row)) {
        context.editor.notify(fmt::format("\"{}\" is locked: unlock it to delete it", *locked), true);
        return;
    }
    // The number would mean another node now.
    if (context.editor.edit([&](edit::Document& document) { return edit::remove_node(document.file, node); }))
        context.editor.select({});
}

// The light is at the side of the performers, above them, and in front of them as the eye sees them.
void add_light_in_view(Context& context, stage::GltfLightKind kind) {
    const Eye& eye = context.view.eye;
    const glm::dmat4 world_from_camera = world_from_eye(eye);
    const glm::dvec3 right(world_from_camera[0]);
    const glm::dvec3 back = glm::dvec3(std::sin(eye.yaw), 0, std::cos(eye.yaw));
    glm::dvec3 aim = eye.pivot;
    if (context.frame.stage && !context.frame.stage->performers.empty()) {
        const auto [low, high] = stage::performers_box(*context.frame.stage, context.frame.evaluated);
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
    add(context, [&](edit::Document& document) { return edit::add_light(document.file, name, edit, placement); });
}

void add_camera_in_view(Context& context) {
    add(context, [&](edit::Document& document) {
        return edit::add_camera(document.file, "camera", context.view.eye.angle_y, world_from_eye(context.view.eye));
    });
}

void handle_node_keys(Context& context, StageTree& tree) {
    const auto node = context.editor.selected();
    if (!node) return;
    for (const ui::KeyPress& press : context.frame.presses) {
        if (press.alt || press.shift || press.repeat) continue;
        if (press.control && press.key == GLFW_KEY_D) duplicate_once(context, *node);
        if (press.control) continue;
        if (press.key == GLFW_KEY_H)
            context.editor.edit(
                [&](edit::Document& d) { return edit::show_node(d.file, *node, !edit::is_visible(d.file, *node)); });
        if (press.key == GLFW_KEY_F2) begin_renaming(tree, *node);
        if (press.key == GLFW_KEY_DELETE) {
            delete_node(context, tree, *node);
            return;
        }
    }
}

}  // namespace neuvv::viewer
