#include <imgui.h>

#include <algorithm>

#include "tools/viewer/panels/panels.h"

namespace neuvv::viewer {

namespace {

template <typename Content>
void tab(Context& context, const char* name, const char* report, bool select, const Content& content) {
    const bool open = ImGui::BeginTabItem(name, nullptr, select ? ImGuiTabItemFlags_SetSelected : 0);
    context.report.item(report);
    if (!open) return;
    ImGui::BeginChild(report);
    content();
    ImGui::EndChild();
    ImGui::EndTabItem();
}

}  // namespace

bool begin_panel(const char* name, const Area& area) {
    ImGui::SetNextWindowPos({area.left, area.top});
    ImGui::SetNextWindowSize({area.width, area.height});
    return ImGui::Begin(name, nullptr,
                        ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove |
                            ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoBringToFrontOnFocus |
                            ImGuiWindowFlags_NoSavedSettings);
}

void scroll_to_row(float top, float height) {
    const float window = ImGui::GetWindowHeight();
    if (top < ImGui::GetScrollY() || top + height > ImGui::GetScrollY() + window)
        ImGui::SetScrollY(std::max(0.0f, top - 0.5f * (window - height)));
}

void properties_panel(Context& context, const Area& area, PropertiesPanel& state, const PropertiesUses& uses) {
    begin_panel("properties_panel", area);
    const bool paints = PaintTool::is_current(context);
    const bool begins_to_paint = paints && !state.painted_before;
    state.painted_before = paints;
    if (ImGui::BeginTabBar("tabs")) {
        tab(context, "Properties", "tab/properties", false, [&] { properties_tab(context, state.fields, uses.tree); });
        tab(context, "Paint", "tab/paint", begins_to_paint, [&] { paint_tab(context, uses.paint, uses.files); });
        tab(context, "Light", "tab/light", false, [&] { light_tab(context, uses.tree); });
        tab(context, "Render", "tab/render", false,
            [&] { render_tab(context, state.export_choice, uses.files, uses.exporter); });
        tab(context, "Coach", "tab/coach", false, [&] { coach_tab(context, uses.coaching); });
        ImGui::EndTabBar();
    }
    ImGui::End();
}

}  // namespace neuvv::viewer
