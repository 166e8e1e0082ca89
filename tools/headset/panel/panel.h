// The content of the panel: time, the tools, the selected performer, lights, comfort, coaching.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tools/headset/hands/interaction.h"

namespace neuvv::headset {

class Coaching;

// What the user pressed that the panel does not do itself, and where its items are.
struct PanelResult {
    bool save = false, save_as = false, leave = false, to_start = false;
    std::filesystem::path open;               // another stage or clip, or an address; mostly empty
    std::map<std::string, glm::dvec2> items;  // by name: the centre of each item, 0..1 from the upper left
    std::vector<std::string> cut_off;         // the labels that are wider than their buttons
};

// What the panel displays beside the state.
struct PanelStatus {
    std::vector<editor::Notice> notices;  // the latest last
    double images_per_second = 0, scale = 1;
    bool saving = false;
    xr::Pose head;           // tracking space
    glm::dvec2 room_m{2.5};  // width and depth of the room's free floor
};

// To be called between ImGui::NewFrame() and Render(). The panel fills the whole display of ImGui.
PanelResult draw_panel(HeadsetState& state, Interaction& interaction, Coaching& coaching, const PanelStatus& status);

}  // namespace neuvv::headset
