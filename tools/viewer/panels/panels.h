// The panels: each a function in a file of its own name, called once a frame.
#pragma once

#include "tools/viewer/viewer.h"

namespace neuvv::viewer {

void menu_bar(Viewer& viewer);
// What is done in the image: looking around, selecting, handles, brushes.
void image_panel(Viewer& viewer);
void stage_panel(Viewer& viewer, const Area& area);       // the tree of nodes
void properties_panel(Viewer& viewer, const Area& area);  // of what is selected; tabs of paint, light, rendering
// Tabs of the properties panel, in files of their own.
void properties_tab(Viewer& viewer);
void paint_tab(Viewer& viewer);
void light_tab(Viewer& viewer);
void render_tab(Viewer& viewer);
void timeline_panel(Viewer& viewer, const Area& area);
void speed_panel(Viewer& viewer);    // how long images take
void help_panel(Viewer& viewer);     // keys
void notices_panel(Viewer& viewer);  // what was told, what is under way

// A panel of the fixed layout: begins an ImGui window there, ImGui::End() ends it.
bool begin_panel(const char* name, const Area& area);

}  // namespace neuvv::viewer
