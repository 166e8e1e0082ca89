#include "tools/viewer/panels/all_panels.h"

#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>

#include "tools/viewer/timeline/timeline_view.h"

namespace neuvv::viewer {

namespace {

// Closes menus and combo boxes by Escape. Modal dialogs handle it themselves.
void close_popup_by_escape(const FrameInput& input) {
    const auto& open = ImGui::GetCurrentContext()->OpenPopupStack;
    if (!input.escape || open.empty()) return;
    const ImGuiWindow* window = open.back().Window;
    if (window && !(window->Flags & ImGuiWindowFlags_Modal)) ImGui::ClosePopupToLevel(open.Size - 1, true);
}

struct PanelAreas {
    Area image, side, below;  // the latter two are empty while the panels are not displayed
};

PanelAreas panel_areas(const Context& context) {
    const PanelLayout& panels = context.view.panels;
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    const float top = ImGui::GetFrameHeight();
    Area side, below;
    if (panels.all) {
        side.width = std::round(std::min(std::max(context.ui(panels.side_width), context.ui(180)), 0.5f * window.x));
        side.left = window.x - side.width;
        side.top = top;
        side.height = window.y - top;
        below.height =
            std::round(std::min(std::max(context.ui(panels.timeline_height), context.ui(80)), 0.5f * (window.y - top)));
        below.width = window.x - side.width;
        below.top = window.y - below.height;
    }
    return {{0, top, window.x - side.width, window.y - top - below.height}, side, below};
}

void place_image(FrameInput& input, const Area& area, const Eye& eye) {
    const ImVec2 pointer = ImGui::GetIO().MousePos;
    input.image_area = area;
    input.camera = camera_of(eye, std::max(1u, static_cast<uint32_t>(area.width)),
                             std::max(1u, static_cast<uint32_t>(area.height)));
    input.pointer_in_image = !ImGui::GetIO().WantCaptureMouse && area.contains(pointer.x, pointer.y);
}

}  // namespace

void Panels::draw(Context& context, FrameInput& input, const PanelUses& uses) {
    PanelLayout& panels = context.view.panels;
    close_popup_by_escape(input);
    menu_bar(context, {uses.files, uses.window, uses.preferences, tree, uses.verb});
    const auto [image, side, below] = panel_areas(context);
    place_image(input, image, context.view.eye);
    tools.toolbar(context);
    tools.handle_pointer(context);
    uses.coaching.draw(context);
    if (panels.all) {
        const float tree_height = std::round(panels.tree_share * side.height);
        stage_panel(context, {side.left, side.top, side.width, tree_height}, tree);
        properties_panel(context, {side.left, side.top + tree_height, side.width, side.height - tree_height},
                         properties, {tree, paint, uses.files, uses.exporter, uses.coaching});
        timeline_panel(context, below, timeline, uses.waveforms);
    }
    statistics_panel(context, uses.device, uses.meter);
    if (panels.help) help_panel(context);
    about_panels(context, uses.device);
    verb_dialog(context, uses.verb, uses.files);
    notices_panel(context, notices.all());
    uses.files.panel();
}

void Panels::document_opened() {
    tools.document_opened();
    timeline.key_drag.reset();
}

}  // namespace neuvv::viewer
