// The panel's page of the stage: its lights, who is on it, and other names for its file.
#include <fmt/format.h>

#include "edit/operations.h"
#include "tools/headset/panel/panel_rows.h"
#include "tools/headset/state/next_document.h"
#include "tools/headset/state/performer_edits.h"
#include "tools/ui/icons.h"

namespace neuvv::headset {

namespace {

void set(HeadsetState& state, const edit::StageEdit& edit) {
    state.editor.edit([&](edit::Document& document) { return edit::set_stage(document.file, edit); });
}

void light_row(Rows& rows) {
    bool shadows = rows.state.stage->settings.shadows, falloff = rows.state.stage->settings.falloff;
    if (rows.checkbox("shadows", "Shadows", &shadows)) set(rows.state, edit::StageEdit{.shadows = shadows});
    ImGui::SameLine();
    if (rows.checkbox("falloff", "Lights on performers", &falloff))
        set(rows.state, edit::StageEdit{.falloff = falloff});
}

void hidden_rows(Rows& rows) {
    const std::vector<uint32_t> hidden = hidden_performers(rows.state);
    ImGui::TextDisabled(hidden.empty() ? "Nobody is hidden." : "Hidden:");
    const float half = column_width(2);
    for (size_t i = 0; i < hidden.size(); ++i) {
        const std::string& name = rows.state.stage->performers[hidden[i]].name;
        if (i % 2 == 1) ImGui::SameLine();
        ImGui::PushID(static_cast<int>(i));  // performers may have the same name
        const bool pressed =
            rows.button(fmt::format("show {}", name).c_str(), fmt::format(ICON_EYE " {}", name).c_str(), half);
        ImGui::PopID();
        if (pressed) show_performer(rows.state, hidden[i]);
    }
}

}  // namespace

void stage_rows(Rows& rows) {
    HeadsetState& state = rows.state;
    const float half = column_width(2);
    if (rows.button("add", ICON_PLUS " Add a performer", half)) {
        state.clips = clips_at_hand(state.editor);
        state.dialogue = PanelDialogue::kClips;
    }
    ImGui::SameLine();
    ImGui::BeginDisabled(rows.status.saving);
    rows.result.save_as = rows.button("save as", ICON_SAVE " Save as a new file", half);
    ImGui::EndDisabled();
    if (rows.button("fit", ICON_SCALE " Fit to the room", half))
        fit_to_room(state, rows.status.head, rows.status.room_m);
    ImGui::SameLine();
    if (rows.button("open", "Open another", half)) {
        state.folder = stage::absolute_path(state.editor.file().path).parent_path();
        state.dialogue = PanelDialogue::kFiles;
    }
    light_row(rows);
    hidden_rows(rows);
}

void clip_rows(Rows& rows, const xr::Pose& head) {
    HeadsetState& state = rows.state;
    if (rows.button("clip cancel", "Cancel", column_width(2))) state.dialogue = PanelDialogue::kNone;
    ImGui::TextDisabled(state.clips.empty() ? "There is no clip beside the stage." : "Who is to stand before you?");
    const float half = column_width(2);
    for (size_t i = 0; i < state.clips.size(); ++i) {
        if (i % 2 == 1) ImGui::SameLine();
        const std::string name = state.clips[i].filename().string();
        ImGui::PushID(static_cast<int>(i));  // clips of different folders may have the same name
        const bool pressed = rows.button(fmt::format("clip {}", name).c_str(), name.c_str(), half);
        ImGui::PopID();
        if (!pressed) continue;
        add_performer(state, state.clips[i], head);
        state.dialogue = PanelDialogue::kNone;
        return;
    }
}

void file_rows(Rows& rows) {
    HeadsetState& state = rows.state;
    const std::vector<float> widths = fitted_widths({"Cancel", "Up", "An address"});
    if (rows.button("file cancel", "Cancel", widths[0])) state.dialogue = PanelDialogue::kNone;
    ImGui::SameLine();
    const std::filesystem::path above = state.folder.parent_path();
    ImGui::BeginDisabled(above == state.folder);
    const bool goes_up = rows.button("file up", "Up", widths[1]);
    ImGui::EndDisabled();
    ImGui::SameLine();
    if (rows.button("file address", "An address", widths[2])) {
        state.typed.clear();
        state.types_address = true;
        state.dialogue = PanelDialogue::kKeyboard;
    }
    ImGui::TextDisabled("%s", state.folder.filename().string().c_str());
    const float half = column_width(2);
    const std::vector<FolderEntry> entries = entries_of(state.folder);
    for (size_t i = 0; i < entries.size(); ++i) {
        if (i % 2 == 1) ImGui::SameLine();
        const std::string name = entries[i].path.filename().string() + (entries[i].is_folder ? "/" : "");
        if (!rows.button(fmt::format("file {}", name).c_str(), name.c_str(), half)) continue;
        if (entries[i].is_folder) {
            state.folder = entries[i].path;
            return;
        }
        rows.result.open = entries[i].path;
        state.dialogue = PanelDialogue::kNone;
    }
    if (goes_up) state.folder = above;
}

}  // namespace neuvv::headset
