// The widgets of the panel, which are large enough for a hand; and the rows that have a file of their own.
#pragma once

#include <imgui.h>

#include "tools/headset/panel.h"

namespace neuvv::headset {

// What the functions that draw the panel's rows need, and what they return.
struct Rows {
    HeadsetState& state;
    Interaction& interaction;
    Training& training;
    const PanelStatus& status;
    PanelResult result;

    // Records the position of the last ImGui item under this name.
    void record_item(const char* name);
    bool button(const char* name, const char* label, float width, bool is_on = false);
    // A button with an icon alone; a tooltip explains it.
    bool icon_button(const char* name, const char* label, const char* tooltip, float width, bool is_on = false);
    // A button that is on or off.
    bool toggle(const char* name, const char* label, float width, bool& value);
    bool checkbox(const char* name, const char* label, bool* value);
};

// The width of each of so many columns, which fill the rest of the row.
float column_width(int columns);

// The page of training with a performer.
void training_rows(Rows& rows);

}  // namespace neuvv::headset
