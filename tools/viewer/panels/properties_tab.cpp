// What is selected: its name and place, and what it is; the stage where nothing is.
#include <imgui.h>

#include "tools/ui/icons.h"
#include "tools/ui/theme.h"
#include "tools/viewer/panels/node_actions.h"
#include "tools/viewer/panels/node_transform.h"
#include "tools/viewer/panels/panels.h"
#include "tools/viewer/panels/property_fields.h"

namespace neuvv::viewer {

namespace {

void drag_place(Viewer& viewer, uint32_t node, const edit::NodeTransform& to) {
    viewer.editor.drag([=](edit::Document& document) {
        return edit::place_node(document.file, node, placement_to(edit::transform_of(document.file, node), to));
    });
}

void turn_field(Viewer& viewer, FieldGroup& group, uint32_t node, edit::NodeTransform place) {
    PropertyFields::Angles& shown = viewer.fields.angles;
    glm::dvec3 deg = shown.node == node ? angles_like(shown.deg, place.rotation) : angles_of(place.rotation);
    for (int axis = 0; axis < 3; axis++)
        if (std::abs(deg[axis]) < 1e-9) deg[axis] = 0;  // no "-0.0"
    shown = {node, deg};
    if (!group.number("rotation", deg, {-3600, 3600, 0.5, "%.1f°"})) return;
    shown.deg = deg;
    place.rotation = turn_of(deg);
    drag_place(viewer, node, place);
}

// Its three numbers beside a sign that ties them together.
void scale_field(Viewer& viewer, FieldGroup& group, uint32_t node, edit::NodeTransform place) {
    group.label("scale");
    const glm::dvec3 before = place.scale;
    const double low = -1e4, high = 1e4;
    const float sign = std::round(1.25f * ImGui::GetFrameHeight());
    ImGui::SetNextItemWidth(ImGui::GetContentRegionAvail().x - sign - ImGui::GetStyle().ItemInnerSpacing.x);
    const bool changed =
        ImGui::DragScalarN("##scale", ImGuiDataType_Double, &place.scale.x, 3, 0.005f, &low, &high, "%.3f");
    group.report_last("scale");
    ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    bool& evenly = viewer.fields.evenly;
    if (icon_button(viewer, "properties/evenly", ICON_LINK, "All three alike", evenly)) evenly = !evenly;
    if (!changed) return;
    const glm::dvec3 kept = kept_off_zero(place.scale, before);
    double factor = 1;
    for (int axis = 0; axis < 3; axis++)
        if (kept[axis] != before[axis] && before[axis] != 0) factor = kept[axis] / before[axis];
    place.scale = evenly ? factor * before : kept;
    drag_place(viewer, node, place);
}

void to_the_floor(Viewer& viewer, uint32_t node) {
    const stage::Stage* const stage = viewer.stage_of_document();
    edit::Placement placement;
    if (stage) placement.move = move_to_floor(*stage, viewer.evaluated, node);
    if (placement.move)
        viewer.editor.edit([&](edit::Document& d) { return edit::place_node(d.file, node, placement); });
    else
        viewer.editor.notify(stage ? "there is nothing of it to stand on the floor" : "still reading the stage", true);
}

void place_buttons(Viewer& viewer, FieldGroup& group, const StageRow& row) {
    group.label("");
    if (row.kind != NodeKind::kLight && row.kind != NodeKind::kCamera) {
        if (ImGui::Button("To the floor")) to_the_floor(viewer, row.node);
        group.report_last("to the floor");
        explain("The lowest of it, now, onto the floor");
        ImGui::SameLine(0, ImGui::GetStyle().ItemInnerSpacing.x);
    }
    if (ImGui::Button("Reset"))
        viewer.editor.edit([&](edit::Document& d) {
            return edit::place_node(d.file, row.node, placement_to(edit::transform_of(d.file, row.node), {}));
        });
    group.report_last("reset");
    explain("In the middle of the stage, not turned, as large as it is");
}

void place_fields(Viewer& viewer, FieldGroup& group, const StageRow& row) {
    const uint32_t node = row.node;
    const edit::NodeTransform place = edit::transform_of(viewer.editor.file(), node);
    headline(row.locked ? "Place  " ICON_LOCK : "Place");
    ImGui::BeginDisabled(row.locked);
    edit::NodeTransform to = place;
    if (group.number("position", to.translation, {-1e6, 1e6, 0.01, "%.3f"})) drag_place(viewer, node, to);
    explain("Metres: to the right, up, to the front");
    turn_field(viewer, group, node, place);
    scale_field(viewer, group, node, place);
    place_buttons(viewer, group, row);
    ImGui::EndDisabled();
}

void camera_fields(Viewer& viewer, FieldGroup& group, uint32_t node) {
    headline("Camera");
    const auto camera = edit::camera_on(viewer.editor.file(), node);
    if (!camera) return;
    if (camera->orthographic) {
        ImGui::TextWrapped("Orthographic: it has no angle of view.");
        return;
    }
    double angle_deg = glm::degrees(camera->vertical_angle_rad);
    if (group.number("angle of view", angle_deg, {1, 150, 0.1, "%.1f°"}))
        viewer.editor.drag([=](edit::Document& d) { return edit::set_camera(d.file, node, glm::radians(angle_deg)); });
    explain("From the lower to the upper edge of the image");
    const stage::Stage* const stage = viewer.stage_of_document();
    group.label("");
    if (ImGui::Button("Look through") && stage)
        for (const stage::EvaluatedCamera& at : viewer.evaluated.cameras)
            if (at.node == node) {
                const auto [low, high] = stage::performers_box(*stage, viewer.evaluated);
                viewer.go_to(looking_through(at.world_from_camera, at.vertical_angle_rad,
                                             distance_to(at.world_from_camera, low, high)));
            }
    group.report_last("look through");
}

void light_hint(FieldGroup& group) {
    headline("Light");
    group.label("");
    ImGui::TextDisabled("See the Light tab.");
}

void name_field(Viewer& viewer, FieldGroup& group, const StageRow& row) {
    std::string name = row.title;
    if (group.text("name", name))
        viewer.editor.edit([&](edit::Document& d) { return edit::rename_node(d.file, row.node, name); });
}

}  // namespace

void explain(const char* text) {
    constexpr double kAfter_s = 0.5;  // that the pointer rests: who is at work is not to be disturbed
    static double moved_s = 0;
    if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled) || ImGui::IsItemActive()) return;
    const ImGuiIO& io = ImGui::GetIO();
    if (io.MouseDelta.x != 0 || io.MouseDelta.y != 0 || ImGui::IsAnyMouseDown()) moved_s = ImGui::GetTime();
    if (ImGui::GetTime() - moved_s < kAfter_s) return;
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

void properties_tab(Viewer& viewer) {
    if (!viewer.editor.is_open()) return;
    follow_document(viewer);
    FieldGroup group(viewer, "properties");
    const auto node = viewer.editor.selected();
    const auto at = node ? row_of(viewer.stage_tree.rows, *node) : std::nullopt;
    if (!at) {
        stage_fields(viewer, group);
        return;
    }
    const StageRow& row = viewer.stage_tree.rows[*at];
    ImGui::PushID(static_cast<int>(row.node));
    name_field(viewer, group, row);
    place_fields(viewer, group, row);
    if (row.kind == NodeKind::kPerformer) performer_fields(viewer, group, row.node);
    if (row.kind == NodeKind::kCamera) camera_fields(viewer, group, row.node);
    if (row.kind == NodeKind::kLight) light_hint(group);
    ImGui::PopID();
}

}  // namespace neuvv::viewer
