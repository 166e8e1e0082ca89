#include <imgui.h>

#include <algorithm>
#include <iterator>

#include "tools/ui/icons.h"
#include "tools/viewer/panels/fields.h"
#include "tools/viewer/panels/panels.h"
#include "tools/viewer/panels/stage_tree.h"
#include "tools/viewer/tools/overlay.h"
#include "voctree/files/clip.h"

namespace neuvv::viewer {

namespace {

// An item that is reported as "menu/NAME".
bool item(Context& context, const char* name, const char* keys, bool enabled = true, bool checked = false) {
    return menu_item(context, std::string("menu/") + name, name, keys, checked, enabled);
}

bool menu(Context& context, const char* name) {
    const bool open = ImGui::BeginMenu(name);
    context.report.item(std::string("menu/") + name);
    return open;
}

void recent_menu(Context& context, const MenuBar& uses) {
    if (!menu(context, "Open recent")) return;
    const std::vector<std::filesystem::path> recent = uses.preferences.recent;
    if (recent.empty()) item(context, "nothing yet", "", false);
    for (const std::filesystem::path& path : recent)
        if (item(context, path.string().c_str(), "")) uses.files.open(path);
    ImGui::EndMenu();
}

// What `neuvv` does with files, each with a dialog. Publishing and exporting begin with the clip that is open.
void verb_items(Context& context, VerbTask& verb) {
    const stage::Stage* stage = context.frame.stage.get();
    const std::filesystem::path clip = stage && !stage->clips.empty() ? stage->clips[0].path : std::filesystem::path();
    for (const VerbForm& form : verb_forms()) {
        const std::string name = form.verb;
        const bool reads_clip = name == "publish" || name == "export";
        if (menu_item(context, "menu/" + name, (std::string(form.title) + "…").c_str(), "", false, !verb.is_running()))
            verb.ask(name, reads_clip ? clip : std::filesystem::path());
    }
    if (verb.is_running()) menu_item(context, "menu/running", "One is under way", "", false, false);
}

void file_menu(Context& context, const MenuBar& uses) {
    if (!menu(context, "File")) return;
    if (item(context, "New", "Ctrl+N")) uses.files.new_stage();
    if (item(context, "Open…", "Ctrl+O")) uses.files.ask_to_open();
    if (item(context, "Add to the stage…", "", context.editor.is_open())) {
        std::vector<std::string> endings{".nvpaint", ".png", ".wav", ".flac", ".ogg", ".mp3", ".m4a"};
        std::ranges::copy(voctree::kClipEndings, std::back_inserter(endings));
        uses.files.ask_path("Add a clip, paint, environment or sound", endings, false, "",
                            [files = &uses.files](const std::filesystem::path& path) { files->open_or_add(path); });
    }
    recent_menu(context, uses);
    ImGui::Separator();
    verb_items(context, uses.verb);
    ImGui::Separator();
    if (item(context, "Save", "Ctrl+S", context.editor.is_open())) uses.files.save();
    if (item(context, "Save as…", "Ctrl+Shift+S", context.editor.is_open())) uses.files.save_as();
    ImGui::Separator();
    if (item(context, "Quit", "Ctrl+Q")) uses.window.close();
    ImGui::EndMenu();
}

void edit_menu(Context& context, StageTree& tree) {
    if (!menu(context, "Edit")) return;
    const edit::History& history = context.editor.history();
    if (item(context, "Undo", "Ctrl+Z", history.next_undo() != nullptr)) context.editor.undo();
    if (item(context, "Redo", "Ctrl+Shift+Z", history.next_redo() != nullptr)) context.editor.redo();
    ImGui::Separator();
    const std::optional<uint32_t> node = context.editor.selected();
    if (item(context, "Duplicate", "Ctrl+D", node.has_value())) duplicate_once(context, *node);
    if (item(context, "Rename", "F2", node.has_value())) begin_renaming(tree, *node);
    if (item(context, "Delete", "Del", node.has_value())) delete_node(context, tree, *node);
    ImGui::EndMenu();
}

// Bookmarks are cameras of the stage, so that they are saved with it and other programs can use them.
void bookmarks(Context& context) {
    if (item(context, "Remember this view", "Ctrl+B", context.editor.is_open())) remember_view(context);
    if (!menu(context, "Look through")) return;
    if (!context.frame.stage || context.frame.evaluated.cameras.empty()) item(context, "no camera yet", "", false);
    for (const stage::EvaluatedCamera& camera : context.frame.evaluated.cameras) {
        if (!item(context, camera.name.c_str(), "", !camera.orthographic)) continue;
        context.go_to(eye_of(camera, *context.frame.stage, context.frame.evaluated));
    }
    ImGui::EndMenu();
}

void sides(Context& context) {
    constexpr struct {
        const char *name, *keys;
        EyeSide side;
    } kSides[] = {{"Front", "Pad 1", EyeSide::kFront}, {"Back", "Ctrl+Pad 1", EyeSide::kBack},
                  {"Right", "Pad 3", EyeSide::kRight}, {"Left", "Ctrl+Pad 3", EyeSide::kLeft},
                  {"Above", "Pad 7", EyeSide::kTop},   {"Below", "Ctrl+Pad 7", EyeSide::kBottom}};
    if (!menu(context, "From the")) return;
    for (const auto& [name, keys, side] : kSides)
        if (item(context, name, keys)) context.go_to(seen_from(context.view.eye, side));
    ImGui::EndMenu();
}

void sizes(Context& context) {
    if (!menu(context, "Size of panels")) return;
    for (const int percent : {75, 100, 125, 150, 200, 250, 300}) {
        const float scale = static_cast<float>(percent) / 100;
        if (item(context, (std::to_string(percent) + " %").c_str(), "", true, context.frame.ui_scale == scale))
            context.requests.ui_scale = scale;
    }
    ImGui::EndMenu();
}

void view_menu(Context& context, ui::Window& window) {
    if (!menu(context, "View")) return;
    bookmarks(context);
    sides(context);
    if (item(context, "Focus", "F")) focus(context);
    ImGui::Separator();
    const auto toggle = [&](const char* name, const char* keys, bool& on) {
        if (item(context, name, keys, true, on)) on = !on;
    };
    sizes(context);
    if (item(context, "Sound", "M", true, context.view.sound)) context.view.sound = !context.view.sound;
    if (item(context, "Full screen", "F11")) window.toggle_full_screen();
    if (item(context, "Panels", "Tab", true, context.view.panels.all))
        context.view.panels.all = !context.view.panels.all;
    ImGui::Separator();
    toggle("Grid", "G", context.view.grid);
    toggle("Axes", "", context.view.axes);
    toggle("Statistics", "", context.view.panels.statistics);
    toggle("Pass times", "", context.view.panels.pass_times);
    ImGui::EndMenu();
}

void help_menu(Context& context) {
    if (!menu(context, "Help")) return;
    PanelLayout& panels = context.view.panels;
    if (item(context, "Guide", "", true, panels.guide)) panels.guide = !panels.guide;
    if (item(context, "Keys", "?", true, panels.help)) panels.help = !panels.help;
    ImGui::Separator();
    if (item(context, "Licence", "", true, panels.licence)) panels.licence = !panels.licence;
    if (item(context, "About NeuVV", "", true, panels.about)) panels.about = !panels.about;
    ImGui::EndMenu();
}

}  // namespace

void menu_bar(Context& context, const MenuBar& uses) {
    if (!ImGui::BeginMainMenuBar()) return;
    file_menu(context, uses);
    edit_menu(context, uses.tree);
    view_menu(context, uses.window);
    help_menu(context);
    ImGui::EndMainMenuBar();
}

}  // namespace neuvv::viewer
