#include "tools/viewer/tools/tools.h"

#include <GLFW/glfw3.h>
#include <imgui.h>

#include "tools/ui/icons.h"
#include "tools/viewer/panels/fields.h"
#include "tools/viewer/tools/overlay.h"
#include "tools/viewer/tools/paint_tool.h"

namespace neuvv::viewer {

// The table of tools. Where two tools could use the pointer, the first one of them gets it.
Tools::Tools(PaintTool& paint) {
    const auto keep = [&](std::unique_ptr<Tool> tool) {
        owned_.push_back(std::move(tool));
        return owned_.back().get();
    };
    all_ = {keep(make_gizmo_tool()), keep(make_light_tool()), &paint, keep(make_navigate_tool())};
}

void Tools::handle_key(Context& context, const ui::KeyPress& press) {
    for (Tool* tool : all_) {
        for (const ToolMode& mode : tool->modes())
            if (!press.control && !press.alt && mode.key == press.key) context.view.mode = &mode;
        tool->handle_key(context, press);
    }
    if (!press.control && !press.alt && press.key == GLFW_KEY_G) context.view.grid = !context.view.grid;
}

void Tools::handle_pointer(Context& context) {
    PointerUse use;
    std::vector<Tool*> order = all_;
    std::stable_partition(order.begin(), order.end(), [](const Tool* tool) { return tool->captures_pointer(); });
    for (Tool* tool : order) tool->handle_pointer(context, use);
    draw_scene_overlay(context);
    for (Tool* tool : all_) tool->overlay(context);
}

bool Tools::is_editing() const {
    return std::any_of(all_.begin(), all_.end(), [](const Tool* tool) { return tool->is_editing(); });
}

void Tools::document_opened() {
    for (Tool* tool : all_) tool->document_opened();
}

void Tools::toolbar(Context& context) const {
    const Area& area = context.frame.image_area;
    ViewState& view = context.view;
    ImGui::SetNextWindowPos({area.left + context.ui(8), area.top + context.ui(8)});
    ImGui::SetNextWindowBgAlpha(0.7f);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {context.ui(5), context.ui(5)});
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, context.ui(5));
    ImGui::Begin("Tools", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoMove);
    constexpr size_t kSwitches = 3;
    size_t buttons = kSwitches;
    for (const Tool* tool : all_) buttons += tool->modes().size();
    const bool one_column =
        static_cast<float>(buttons + 1) * ImGui::GetFrameHeightWithSpacing() + context.ui(16) < area.height;
    ImGui::BeginGroup();
    for (const Tool* tool : all_)
        for (const ToolMode& mode : tool->modes())
            if (icon_button(context, mode.name, mode.icon, mode.tooltip, view.mode == &mode)) view.mode = &mode;
    if (one_column) ImGui::Separator();
    ImGui::EndGroup();
    if (!one_column) ImGui::SameLine();
    ImGui::BeginGroup();
    const auto toggle = [&](const char* name, const char* icon, const char* tooltip, bool& on) {
        if (icon_button(context, name, icon, tooltip, on)) on = !on;
    };
    toggle("tool/snap", ICON_MAGNET, "In steps of 0.1 m, 15°, 0.1 (Ctrl turns it round)", view.snap);
    toggle("tool/local", ICON_BOX, "Along the node's own axes", view.local_axes);
    toggle("tool/grid", ICON_GRID, "Lines on the floor (G)", view.grid);
    ImGui::EndGroup();
    ImGui::End();
    ImGui::PopStyleVar(2);
}

}  // namespace neuvv::viewer
