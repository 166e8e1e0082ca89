// The questions about files (FileQuestion).
#include <imgui.h>
#include <imgui_stdlib.h>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>

#include "base/error.h"
#include "editor/open_file.h"
#include "media/image_sink.h"
#include "tools/ui/icons.h"
#include "tools/viewer/context.h"
#include "tools/viewer/files.h"

namespace neuvv::viewer {

namespace {

bool button(Context& context, const char* name, bool enabled = true) {
    ImGui::BeginDisabled(!enabled);
    const bool pressed = ImGui::Button(name, {context.ui(110), 0});
    ImGui::EndDisabled();
    context.report.item(std::string("question/") + name);
    ImGui::SameLine();
    return pressed;
}

// The first file of numbered images; else the path itself.
std::filesystem::path first_of(const std::filesystem::path& path) {
    try {
        return media::parse_output(path.string()).file(0);
    } catch (const InputError&) {
        return path;
    }
}

}  // namespace

void Files::panel() {
    constexpr const char* kName = "###question";
    if (!question_) return;
    const char* titles[] = {"Unsaved edits", "Recover edits", question_->title.c_str(), question_->title.c_str()};
    const std::string title = std::string(titles[static_cast<size_t>(question_->kind)]) + kName;
    if (!ImGui::IsPopupOpen(title.c_str())) ImGui::OpenPopup(title.c_str());
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({size.x / 2, size.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
    if (!ImGui::BeginPopupModal(
            title.c_str(), nullptr,
            ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoMove))
        return;
    switch (question_->kind) {
        case FileQuestion::Kind::kUnsaved:
            unsaved_panel();
            break;
        case FileQuestion::Kind::kRecover:
            recover_panel();
            break;
        case FileQuestion::Kind::kPath:
            path_panel();
            break;
        case FileQuestion::Kind::kStop:
            stop_panel();
            break;
    }
    if (!question_) ImGui::CloseCurrentPopup();
    ImGui::EndPopup();
}

void Files::unsaved_panel() {
    ImGui::Text("%s has edits that are not saved.", context_.editor.file().path.filename().string().c_str());
    ImGui::Spacing();
    const auto afterwards = question_->afterwards;
    if (button(context_, "Save")) {
        const bool on_disk = context_.editor.file().saved->on_disk;
        close_question();
        if (on_disk)
            save_to(context_.editor.file().path, afterwards);
        else
            ask_path("Save stage as", {".gltf"}, true, context_.editor.file().path.filename().string(),
                     [this, afterwards](const std::filesystem::path& path) { save_to(path, afterwards); });
        return;
    }
    if (button(context_, "Discard")) {
        close_question();
        saver_.autosave.forget();
        afterwards();
        return;
    }
    if (button(context_, "Cancel") || context_.frame.escape) close_question();
}

void Files::recover_panel() {
    const edit::RecoveryEntry& entry = question_->entries.front();
    const auto when = static_cast<std::time_t>(entry.when_s);
    ImGui::TextUnformatted(fmt::format("{} was edited until {:%F %H:%M:%S} and not saved.",
                                       entry.stage.filename().string(), fmt::localtime(when))
                               .c_str());
    ImGui::TextDisabled("%s", entry.stage.parent_path().c_str());
    if (edit::has_foreign_file(entry))
        ImGui::TextUnformatted("Its file has changed since: saving keeps that beside it, under another name.");
    ImGui::Spacing();
    if (button(context_, "Recover")) {
        const edit::RecoveryEntry recovered = entry;
        close_question();
        return recover(recovered);
    }
    const auto then = question_->then;
    const std::filesystem::path path = question_->folder;
    if (button(context_, "Discard")) {
        for (const edit::RecoveryEntry& lost : question_->entries) edit::discard(lost);
        close_question();
        return then(path);
    }
    if (button(context_, "Decide later") || context_.frame.escape) {
        close_question();
        then(path);
    }
}

void Files::stop_panel() {
    ImGui::TextUnformatted("It still runs. Closing the window stops it.");
    ImGui::Spacing();
    const auto afterwards = question_->afterwards;
    if (button(context_, "Stop")) {
        close_question();
        return afterwards();
    }
    if (button(context_, "Cancel") || context_.frame.escape) close_question();
}

void Files::path_panel() {
    FileQuestion& question = *question_;
    const ImVec2 window = ImGui::GetIO().DisplaySize;
    const ImVec2 list{std::min(context_.ui(560), window.x - context_.ui(60)),
                      std::min(context_.ui(320), window.y - context_.ui(190))};
    if (ImGui::Button(ICON_LEVEL_UP)) return list_folder(question.folder.parent_path());
    context_.report.item("question/up");
    ImGui::SameLine();
    std::string folder = question.folder.string();
    ImGui::SetNextItemWidth(list.x - ImGui::GetItemRectSize().x - ImGui::GetStyle().ItemSpacing.x);
    if (ImGui::InputText("##folder", &folder, ImGuiInputTextFlags_EnterReturnsTrue)) return list_folder(folder);
    context_.report.item("question/folder");
    ImGui::BeginChild("files", list, true);
    for (const ListedFile& listed : listed_) {
        const std::string text = fmt::format("{}  {}", listed.folder ? ICON_FOLDER : ICON_FILE, listed.name);
        const bool clicked = ImGui::Selectable(text.c_str(), !listed.folder && listed.name == question.name,
                                               ImGuiSelectableFlags_AllowDoubleClick);
        context_.report.item("question/file/" + listed.name);
        if (!clicked) continue;
        if (listed.folder) {
            list_folder(question.folder / listed.name);
            break;
        }
        question.name = listed.name;
        if (ImGui::IsMouseDoubleClicked(ImGuiMouseButton_Left)) {
            ImGui::EndChild();
            return choose(question.folder / question.name);
        }
    }
    ImGui::EndChild();
    ImGui::SetNextItemWidth(list.x);
    if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
    const bool entered = ImGui::InputText("##name", &question.name,
                                          ImGuiInputTextFlags_EnterReturnsTrue | ImGuiInputTextFlags_AutoSelectAll);
    context_.report.item("question/name");
    if (!confirmed_.empty() && confirmed_ == question.folder / question.name)
        ImGui::TextUnformatted("There is a file of this name. Save again to replace it.");
    const bool folders = question.wants_folder();
    if (button(context_, question.to_save ? "Save" : "Open", folders || !question.name.empty()) || entered)
        return folders ? choose_folder() : choose(question.folder / question.name);
    if (button(context_, "Cancel") || context_.frame.escape) close_question();
}

// The folder that is listed, or the one in it whose name was typed.
void Files::choose_folder() {
    const std::filesystem::path path =
        question_->name.empty() ? question_->folder : question_->folder / question_->name;
    const auto then = question_->then;
    close_question();
    then(path);
}

void Files::choose(const std::filesystem::path& selected) {
    std::filesystem::path path = selected;
    std::error_code error;
    if (is_plain_folder(path)) return list_folder(path);
    const std::vector<std::string>& endings = question_->endings;
    const bool listed = std::find(endings.begin(), endings.end(), path.extension()) != endings.end();
    const bool has_ending = listed || (!endings.empty() && editor::has_stage_ending("x" + endings[0]) &&
                                       editor::has_stage_ending(path.string()));
    if (question_->to_save && !endings.empty() && !has_ending) path += endings[0];
    if (question_->to_save && confirmed_ != path && std::filesystem::exists(first_of(path), error)) {
        question_->name = path.filename().string();
        confirmed_ = path;
        return;
    }
    const auto then = question_->then;
    close_question();
    then(path);
}

}  // namespace neuvv::viewer
