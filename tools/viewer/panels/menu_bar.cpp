#include <imgui.h>

#include "tools/ui/icons.h"
#include "tools/viewer/panels/node_actions.h"
#include "tools/viewer/panels/panels.h"

namespace neuvv::viewer {

namespace {

// An item that a report knows by "menu/…".
bool item(Viewer& viewer, const char* name, const char* keys, bool enabled = true, bool checked = false) {
    const bool chosen = ImGui::MenuItem(name, keys, checked, enabled);
    viewer.report.item(std::string("menu/") + name);
    return chosen;
}

bool menu(Viewer& viewer, const char* name) {
    const bool open = ImGui::BeginMenu(name);
    viewer.report.item(std::string("menu/") + name);
    return open;
}

void recent_menu(Viewer& viewer) {
    if (!menu(viewer, "Open recent")) return;
    const std::vector<std::filesystem::path> recent = viewer.preferences.recent;
    if (recent.empty()) item(viewer, "nothing yet", "", false);
    for (const std::filesystem::path& path : recent)
        if (item(viewer, path.string().c_str(), "")) viewer.files.open(path);
    ImGui::EndMenu();
}

void file_menu(Viewer& viewer) {
    if (!menu(viewer, "File")) return;
    if (item(viewer, "New", "Ctrl+N")) viewer.files.new_stage();
    if (item(viewer, "Open…", "Ctrl+O"))
        viewer.files.ask_path("Open", {".gltf", ".glb", ".nvv", ".npz"}, false, "",
                              [&viewer](const std::filesystem::path& path) { viewer.files.open(path); });
    if (item(viewer, "Add to the stage…", "", viewer.editor.is_open()))
        viewer.files.ask_path("Add a clip, paint or environment", {".nvv", ".npz", ".nvpaint", ".png"}, false, "",
                              [&viewer](const std::filesystem::path& path) { viewer.files.take(path); });
    recent_menu(viewer);
    ImGui::Separator();
    if (item(viewer, "Save", "Ctrl+S", viewer.editor.is_open())) viewer.files.save();
    if (item(viewer, "Save as…", "Ctrl+Shift+S", viewer.editor.is_open())) viewer.files.save_as();
    ImGui::Separator();
    if (item(viewer, "Quit", "Ctrl+Q")) viewer.window.close();
    ImGui::EndMenu();
}

void edit_menu(Viewer& viewer) {
    if (!menu(viewer, "Edit")) return;
    const edit::History& history = viewer.editor.history();
    if (item(viewer, "Undo", "Ctrl+Z", history.next_undo() != nullptr)) viewer.editor.undo();
    if (item(viewer, "Redo", "Ctrl+Shift+Z", history.next_redo() != nullptr)) viewer.editor.redo();
    ImGui::Separator();
    const std::optional<uint32_t> node = viewer.editor.selected();
    if (item(viewer, "Duplicate", "Ctrl+D", node.has_value())) duplicate_once(viewer, *node);
    if (item(viewer, "Rename", "F2", node.has_value())) begin_renaming(viewer, *node);
    if (item(viewer, "Delete", "Del", node.has_value())) delete_node(viewer, *node);
    ImGui::EndMenu();
}

// Bookmarks are cameras of the stage: saved with it, seen by other programs.
void bookmarks(Viewer& viewer) {
    if (item(viewer, "Remember this view", "Ctrl+B", viewer.editor.is_open())) remember_view(viewer);
    if (!menu(viewer, "Look through")) return;
    if (!viewer.stage || viewer.evaluated.cameras.empty()) item(viewer, "no camera yet", "", false);
    for (const stage::EvaluatedCamera& camera : viewer.evaluated.cameras) {
        if (!item(viewer, camera.name.c_str(), "", !camera.orthographic)) continue;
        const auto [low, high] = stage::performers_box(*viewer.stage, viewer.evaluated);
        viewer.go_to(looking_through(camera.world_from_camera, camera.vertical_angle_rad,
                                     distance_to(camera.world_from_camera, low, high)));
    }
    ImGui::EndMenu();
}

void sides(Viewer& viewer) {
    constexpr struct {
        const char *name, *keys;
        EyeSide side;
    } kSides[] = {{"Front", "Pad 1", EyeSide::kFront}, {"Back", "Ctrl+Pad 1", EyeSide::kBack},
                  {"Right", "Pad 3", EyeSide::kRight}, {"Left", "Ctrl+Pad 3", EyeSide::kLeft},
                  {"Above", "Pad 7", EyeSide::kTop},   {"Below", "Ctrl+Pad 7", EyeSide::kBottom}};
    if (!menu(viewer, "From the")) return;
    for (const auto& one : kSides)
        if (item(viewer, one.name, one.keys)) viewer.go_to(seen_from(viewer.eye, one.side));
    ImGui::EndMenu();
}

void sizes(Viewer& viewer) {
    if (!menu(viewer, "Size of panels")) return;
    for (const int percent : {75, 100, 125, 150, 200, 250, 300}) {
        const float scale = static_cast<float>(percent) / 100;
        if (item(viewer, (std::to_string(percent) + " %").c_str(), "", true, viewer.screen.scale() == scale))
            viewer.wanted_scale = scale;
    }
    ImGui::EndMenu();
}

void view_menu(Viewer& viewer) {
    if (!menu(viewer, "View")) return;
    bookmarks(viewer);
    sides(viewer);
    if (item(viewer, "Focus", "F")) focus(viewer);
    ImGui::Separator();
    sizes(viewer);
    if (item(viewer, "Full screen", "F11")) viewer.window.toggle_full_screen();
    if (item(viewer, "Panels", "Tab", true, viewer.panels.all)) viewer.panels.all = !viewer.panels.all;
    if (item(viewer, "Speed", "", true, viewer.panels.speed)) viewer.panels.speed = !viewer.panels.speed;
    ImGui::EndMenu();
}

void help_menu(Viewer& viewer) {
    if (!menu(viewer, "Help")) return;
    if (item(viewer, "Keys", "?", true, viewer.panels.help)) viewer.panels.help = !viewer.panels.help;
    ImGui::EndMenu();
}

}  // namespace

void menu_bar(Viewer& viewer) {
    if (!ImGui::BeginMainMenuBar()) return;
    file_menu(viewer);
    edit_menu(viewer);
    view_menu(viewer);
    help_menu(viewer);
    ImGui::EndMainMenuBar();
}

}  // namespace neuvv::viewer
