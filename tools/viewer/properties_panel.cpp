#include <imgui.h>

#include "tools/viewer/panels.h"

namespace neuvv {

namespace {

void tab(Viewer& viewer, const char* name, const char* report, void (*content)(Viewer&)) {
    const bool open = ImGui::BeginTabItem(name);
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
    if (ImGui::BeginTabBar("tabs")) {
        tab(viewer, "Properties", "tab/properties", properties_tab);
        tab(viewer, "Paint", "tab/paint", paint_tab);
        tab(viewer, "Light", "tab/light", light_tab);
        tab(viewer, "Render", "tab/render", render_tab);
        ImGui::EndTabBar();
    }
    ImGui::End();
}

}  // namespace neuvv
