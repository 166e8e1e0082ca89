// What the panel shows: time, the tools, the selected performer, light, comfort.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tools/headset/interaction.h"

namespace neuvv::headset {

// What is asked of whoever has files.
struct PanelAsks {
    bool save = false, leave = false;
    std::map<std::string, glm::dvec2> items;  // the middles of what can be pressed, 0..1 from the upper left
};

struct PanelFacts {
    std::vector<editor::Notice> notices;  // the latest last
    double images_per_second = 0, scale = 1;
    bool saving = false;
};

// Between ImGui::NewFrame() and Render(); fills ImGui's whole display.
PanelAsks draw_panel(OnStage& on, Interaction& interaction, const PanelFacts& facts);

}  // namespace neuvv::headset
