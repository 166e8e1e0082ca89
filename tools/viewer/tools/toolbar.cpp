#include <GLFW/glfw3.h>
#include <imgui.h>

#include "edit/operations.h"
#include "tools/ui/icons.h"
#include "tools/viewer/panels/fields.h"
#include "tools/viewer/tools/image_tools.h"
#include "tools/viewer/viewer.h"

namespace neuvv::viewer {

void focus(Viewer& viewer) {
    if (!viewer.stage) return;
    const bool selected = viewer.editor.selected() && viewer.stage_of_document();
    auto [low, high] = stage::performers_box(*viewer.stage, viewer.evaluated);
    if (selected) {
        const auto [node_low, node_high] = box_of_node(viewer, *viewer.editor.selected());
        const bool is_point = node_low == node_high;  // a light, a camera: with those whom it lights or sees
        low = is_point ? glm::min(low, node_low) : node_low;
        high = is_point ? glm::max(high, node_high) : node_high;
    }
    viewer.go_to(framed(viewer.eye, low, high, viewer.image_area.width / viewer.image_area.height));
}

void remember_view(Viewer& viewer) {
    if (!viewer.editor.is_open()) return;
    viewer.editor.edit([&](edit::Document& d) {
        return edit::add_camera(d.file, "view", viewer.eye.angle_y, world_from_eye(viewer.eye));
    });
}

void take_image_key(Viewer& viewer, const ui::KeyPress& press) {
    const auto side = [&](EyeSide one, EyeSide other) {
        viewer.go_to(seen_from(viewer.eye, press.control ? other : one));
    };
    if (press.key == GLFW_KEY_KP_1) side(EyeSide::kFront, EyeSide::kBack);
    if (press.key == GLFW_KEY_KP_3) side(EyeSide::kRight, EyeSide::kLeft);
    if (press.key == GLFW_KEY_KP_7) side(EyeSide::kTop, EyeSide::kBottom);
    if (press.key == GLFW_KEY_B && press.control) remember_view(viewer);
    if (press.control || press.alt) return;
    if (press.key == GLFW_KEY_1) viewer.tool = Tool::kMove;
    if (press.key == GLFW_KEY_2) viewer.tool = Tool::kRotate;
    if (press.key == GLFW_KEY_3) viewer.tool = Tool::kScale;
    if (press.key == GLFW_KEY_4) viewer.tool = Tool::kPaint;
    if (press.key == GLFW_KEY_F) focus(viewer);
    if (press.key == GLFW_KEY_G) viewer.grid = !viewer.grid;
}

void toolbar(Viewer& viewer) {
    const Area& area = viewer.image_area;
    ImGui::SetNextWindowPos({area.left + viewer.ui(8), area.top + viewer.ui(8)});
    ImGui::SetNextWindowBgAlpha(0.7f);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {viewer.ui(5), viewer.ui(5)});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, viewer.ui(5));
    ImGui::Begin("Tools", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoMove);
    const auto tool = [&](const char* name, const char* sign, const char* explained, Tool one) {
        if (icon_button(viewer, name, sign, explained, viewer.tool == one)) viewer.tool = one;
    };
    constexpr float kButtons = 7;
    const bool one_column = (kButtons + 1) * ImGui::GetFrameHeightWithSpacing() + viewer.ui(16) < area.height;
    ImGui::BeginGroup();
    tool("tool/move", ICON_MOVE, "Move (1)", Tool::kMove);
    tool("tool/rotate", ICON_ROTATE, "Rotate (2)", Tool::kRotate);
    tool("tool/scale", ICON_SCALE, "Scale (3)", Tool::kScale);
    tool("tool/paint", ICON_BRUSH, "Paint (4)", Tool::kPaint);
    if (one_column) ImGui::Separator();
    ImGui::EndGroup();
    if (!one_column) ImGui::SameLine();
    ImGui::BeginGroup();
    if (icon_button(viewer, "tool/snap", ICON_MAGNET, "In steps of 0.1 m, 15°, 0.1 (Ctrl turns it round)", viewer.snap))
        viewer.snap = !viewer.snap;
    if (icon_button(viewer, "tool/local", ICON_BOX, "Along the node's own axes", viewer.local_axes))
        viewer.local_axes = !viewer.local_axes;
    if (icon_button(viewer, "tool/grid", ICON_GRID, "Lines on the floor (G)", viewer.grid)) viewer.grid = !viewer.grid;
    ImGui::EndGroup();
    ImGui::End();
    ImGui::PopStyleVar(2);
}

}  // namespace neuvv::viewer
