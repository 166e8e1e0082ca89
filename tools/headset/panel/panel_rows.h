// The widgets of the panel, which are large enough for a hand; and the rows that have a file of their own.
#pragma once

#include <imgui.h>

#include <functional>

#include "tools/headset/panel/panel.h"

namespace neuvv::headset {

// What the functions that draw the panel's rows need, and what they return.
struct Rows {
    HeadsetState& state;
    Interaction& interaction;
    Coaching& coaching;
    const PanelStatus& status;
    PanelResult result;
    bool slider_held = false;  // whether a hand holds a slider that edits the document

    // Records the position of the last ImGui item under this name.
    void record_item(const char* name);
    bool button(const char* name, const char* label, float width, bool is_on = false);
    // A button with an icon alone; a tooltip explains it.
    bool icon_button(const char* name, const char* label, const char* tooltip, float width, bool is_on = false);
    // A button that is on or off.
    bool toggle(const char* name, const char* label, float width, bool& value);
    bool checkbox(const char* name, const char* label, bool* value);
    // A slider over the rest of the row; `format` has the value and what it is.
    bool slider(const char* name, const char* format, double& value, double low, double high,
                ImGuiSliderFlags flags = 0);
    // The same for a value of the document: `operation` makes the edit for the value that the slider shows. The edit is
    // previewed while a hand holds the slider, and is one step of the history when the hand lets go.
    void edit_slider(const char* name, const char* format, double value, double low, double high,
                     const std::function<std::string(edit::Document&, double)>& operation, ImGuiSliderFlags flags = 0);
    // The same for the last ImGui item, whose value has changed or not in this frame.
    void drag_by_item(bool changed, const editor::Editor::Operation& operation);
};

// The width of each of so many columns, which fill the rest of the row.
float column_width(int columns);
// The widths of buttons that fill the rest of the row, so that each has the same room around its label.
std::vector<float> fitted_widths(const std::vector<const char*>& labels);

// The page of the stage; and, in place of the tool's rows, the clips that may be added before the user's head
// (tracking space), and the keyboard that renames the selected performer.
void stage_rows(Rows& rows);
void clip_rows(Rows& rows, const xr::Pose& head);
void file_rows(Rows& rows);  // the stages and clips of a folder
void keyboard_rows(Rows& rows);

// The page of coaching with a performer.
void coaching_rows(Rows& rows);
// The pages about the time and the copies of the selected performer.
void performer_time_rows(Rows& rows);
void copies_rows(Rows& rows);
// The page of the tool kLights: the selected light or camera.
void lights_rows(Rows& rows);

// The selected performer; null where there is none.
const stage::StagePerformer* selected_performer(const HeadsetState& state);
// A line with the name of the selected performer and the time of its clip that is shown.
void performer_title(const HeadsetState& state);

}  // namespace neuvv::headset
