#include <imgui.h>

#include "tools/viewer/panels/panels.h"

namespace neuvv::viewer {

namespace {

void tab(Viewer& viewer, const char* name, const char* report, void (*content)(Viewer&), bool bring = false) {
    const bool open = ImGui::BeginTabItem(name, nullptr, bring ? ImGuiTabItemFlags_SetSelected : 0);
    viewer.report.item(report);
    if (!open) return;
    ImGui::BeginChild(report);
    content(viewer);
    ImGui::EndChild();
    ImGui::EndTabItem();
}

}  // namespace

void properties_panel(Viewer& viewer, const Area& area) {
    begin_panel("properties_panel", area);
    const bool paints = viewer.tool == Tool::kPaint && viewer.panels.seen_tool != Tool::kPaint;
    viewer.panels.seen_tool = viewer.tool;
    if (ImGui::BeginTabBar("tabs")) {
        tab(viewer, "Properties", "tab/properties", properties_tab);
        tab(viewer, "Paint", "tab/paint", paint_tab, paints);
        tab(viewer, "Light", "tab/light", light_tab);
        tab(viewer, "Render", "tab/render", render_tab);
        ImGui::EndTabBar();
    }
    ImGui::End();
}

}  // namespace neuvv::viewer
