// The tab of properties: the name, the transform and the values of the selected node, or those of the stage.
#include <imgui.h>

#include "tools/ui/icons.h"
#include "tools/ui/theme.h"
#include "tools/viewer/panels/node_transform.h"
#include "tools/viewer/panels/panels.h"
#include "tools/viewer/panels/property_fields.h"
#include "tools/viewer/panels/stage_tree.h"
#include "tools/viewer/tools/overlay.h"

namespace neuvv::viewer {

namespace {

void drag_transform(Context& context, uint32_t node, const edit::NodeTransform& to) {
    context.editor.drag([=](edit::Document& document) {
        return edit::place_node(document.file, node, placement_to(edit::transform_of(document.file, node), to));
    });
}

void rotation_field(Context& context, FieldGroup& group, PropertyFields::Angles& displayed, uint32_t node,
                    edit::NodeTransform transform) {
    glm::dvec3 deg =
        displayed.node == node ? angles_like(displayed.deg, transform.rotation) : angles_of(transform.rotation);
    for (int axis = 0; axis < 3; ++axis)
        if (std::abs(deg[axis]) < 1e-9) deg[axis] = 0;  // no "-0.0"
    displayed = {node, deg};
    if (!group.number("rotation", deg, {-3600, 3600, 0.5, "%.1f°"})) return;
    displayed.deg = deg;
    transform.rotation = rotation_of(deg);
    drag_transform(context, node, transform);
}

// The three numbers, and beside them the button that scales all axes by the same factor.
void scale_field(Context& context, FieldGroup& group, bool& evenly, uint32_t node, edit::NodeTransform transform) {
    group.label("scale");
    const glm::dvec3 before = transform.scale;
    const double low = -1e4, high = 1e4;
    const float button = std::round(1.25f * ImGui::GetFrameHeight());
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - button - ImGui::GetStyle().ItemInnerSpacing.x);
    const bool changed =
        ImGui::DragScalarN("##scale", ImGuiDataType_Double, &transform.scale.x, 3, 0.005f, &low, &high, "%.3f");
    group.report_last("scale");
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    if (icon_button(context, "properties/evenly", ICON_LINK, "All three alike", evenly)) evenly = !evenly;
    if (!changed) return;
    const glm::dvec3 scale = nonzero_scale(transform.scale, before);
    double factor = 1;
    for (int axis = 0; axis < 3; ++axis)
        if (scale[axis] != before[axis] && before[axis] != 0) factor = scale[axis] / before[axis];
    transform.scale = evenly ? factor * before : scale;
    drag_transform(context, node, transform);
}

void to_the_floor(Context& context, uint32_t node) {
    const stage::Stage* const stage = context.stage_of_document();
    edit::Placement placement;
    if (stage) placement.move = move_to_floor(*stage, context.frame.evaluated, node);
    if (placement.move)
        context.editor.edit([&](edit::Document& d) { return edit::place_node(d.file, node, placement); });
    else
        context.editor.notify(stage ? "there is nothing of it to stand on the floor" : "still reading the stage", true);
}

void transform_buttons(Context& context, FieldGroup& group, const StageRow& row) {
    group.label("");
    if (row.kind != NodeKind::kLight && row.kind != NodeKind::kCamera) {
        if (ImGui::Button("To the floor")) to_the_floor(context, row.node);
        group.report_last("to the floor");
        explain("The lowest of it, now, onto the floor");
        ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    }
    if (ImGui::Button("Reset"))
        context.editor.edit([&](edit::Document& d) {
            return edit::place_node(d.file, row.node, placement_to(edit::transform_of(d.file, row.node), {}));
        });
    group.report_last("reset");
    explain("In the centre of the stage, not turned, as large as it is");
}

void transform_fields(Context& context, FieldGroup& group, PropertyFields& fields, const StageRow& row) {
    const uint32_t node = row.node;
    const edit::NodeTransform transform = edit::transform_of(context.editor.file(), node);
    headline(row.locked ? "Place  " ICON_LOCK : "Place");
    ImGui::BeginDisabled(row.locked);
    edit::NodeTransform to = transform;
    if (group.number("position", to.translation, {-1e6, 1e6, 0.01, "%.3f"})) drag_transform(context, node, to);
    explain("Metres: to the right, up, to the front");
    rotation_field(context, group, fields.angles, node, transform);
    scale_field(context, group, fields.evenly, node, transform);
    transform_buttons(context, group, row);
    ImGui::EndDisabled();
}

void camera_fields(Context& context, FieldGroup& group, uint32_t node) {
    headline("Camera");
    const auto camera = edit::camera_on(context.editor.file(), node);
    if (!camera) return;
    if (camera->orthographic) {
        ImGui::TextWrapped("Orthographic: it has no angle of view.");
        return;
    }
    double angle_deg = glm::degrees(camera->vertical_angle_rad);
    if (group.number("angle of view", angle_deg, {1, 150, 0.1, "%.1f°"}))
        context.editor.drag([=](edit::Document& d) { return edit::set_camera(d.file, node, glm::radians(angle_deg)); });
    explain("From the lower to the upper edge of the image");
    const stage::Stage* const stage = context.stage_of_document();
    group.label("");
    if (ImGui::Button("Look through") && stage)
        for (const stage::EvaluatedCamera& at : context.frame.evaluated.cameras)
            if (at.node == node) context.go_to(eye_of(at, *stage, context.frame.evaluated));
    group.report_last("look through");
}

void light_hint(FieldGroup& group) {
    headline("Light");
    group.label("");
    ImGui::TextDisabled("See the Light tab.");
}

void name_field(Context& context, FieldGroup& group, const StageRow& row) {
    std::string name = row.title;
    if (group.text("name", name))
        context.editor.edit([&](edit::Document& d) { return edit::rename_node(d.file, row.node, name); });
}

}  // namespace

void explain(const char* text) {
    constexpr double kRest_s = 0.5;  // the pointer must rest so long, so that tooltips do not disturb work
    static double moved_s = 0;
    if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled) || ImGui::IsItemActive()) return;
    const ImGuiIO& io = ImGui::GetIO();
    if (io.MouseDelta.x != 0 || io.MouseDelta.y != 0 || ImGui::IsAnyMouseDown()) moved_s = ImGui::GetTime();
    if (ImGui::GetTime() - moved_s < kRest_s) return;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(22 * ImGui::GetFontSize());
    ImGui::TextUnformatted(text);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

void headline(const char* text) {
    ImGui::Dummy({0, 0.25f * ImGui::GetFontSize()});
    ImGui::TextDisabled("%s", text);
    ImGui::Separator();
}

void properties_tab(Context& context, PropertyFields& fields, StageTree& tree) {
    if (!context.editor.is_open()) return;
    follow_document(context, tree);
    FieldGroup group(context, "properties");
    const auto node = context.editor.selected();
    const auto at = node ? row_of(tree.rows, *node) : std::nullopt;
    if (!at) {
        stage_fields(context, group);
        return;
    }
    const StageRow& row = tree.rows[*at];
    ImGui::PushID(static_cast<int>(row.node));
    name_field(context, group, row);
    transform_fields(context, group, fields, row);
    if (row.kind == NodeKind::kPerformer) performer_fields(context, group, fields.time, row.node);
    if (row.kind == NodeKind::kCamera) camera_fields(context, group, row.node);
    if (row.kind == NodeKind::kLight) light_hint(group);
    ImGui::PopID();
}

}  // namespace neuvv::viewer
