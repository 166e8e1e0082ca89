#include <imgui.h>

#include "tools/viewer/panels/panels.h"

namespace neuvv::viewer {

namespace {

struct KeyLine {
    const char *keys, *what;
};

constexpr KeyLine kKeys[] = {
    {"left drag", "orbit"},
    {"middle drag, Shift + left drag", "pan"},
    {"right drag", "look around"},
    {"wheel", "closer, farther"},
    {"two fingers", "orbit; with Shift pan, with Ctrl closer"},
    {"W A S D Q E", "fly; Shift fast, Alt slow"},
    {"F", "focus on what is selected"},
    {"number pad 1 3 7", "from the front, the right, above; with Ctrl from the other side"},
    {"Ctrl+B", "remember this view as a camera"},
    {"click", "select"},
    {"1 2 3 4", "move, rotate, scale, paint"},
    {"Ctrl, Esc while dragging", "snap or not; as it was"},
    {"click a number", "type it; drag it to change it"},
    {"H, F2, Del, Ctrl+D", "hide, rename, delete, duplicate"},
    {"[ ], Alt + click, Ctrl", "smaller, larger brush; take a colour; erase"},
    {"Space, M", "play, pause; with sound or without"},
    {", . Home End", "the image before, the next; first, last"},
    {"Enter, Shift+Enter", "add a key of the camera path, remove it"},
    {"Ctrl+Z, Ctrl+Shift+Z", "undo, redo"},
    {"Ctrl+N O S, Ctrl+Shift+S", "new, open, save, save as"},
    {"G, Tab, F11", "lines on the floor, panels, full screen"},
    {"F12, Shift+F12", "the image, the window as a PNG"},
    {"?", "this list"},
};

}  // namespace

void help_panel(Context& context) {
    if (context.frame.escape) context.view.panels.help = false;
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({size.x / 2, size.y / 2}, ImGuiCond_Appearing, {0.5f, 0.5f});
    if (ImGui::Begin(
            "Keys", &context.view.panels.help,
            ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse)) {
        if (ImGui::BeginTable("keys", 2, ImGuiTableFlags_SizingFixedFit)) {
            for (const KeyLine& line : kKeys) {
                ImGui::TableNextRow();
                ImGui::TableNextColumn();
                ImGui::TextUnformatted(line.keys);
                ImGui::TableNextColumn();
                ImGui::TextDisabled("%s", line.what);
            }
            ImGui::EndTable();
        }
    }
    ImGui::End();
}

}  // namespace neuvv::viewer
