// How a stage is looked at: what the viewer's user sets and what is not saved with the stage.
#pragma once

#include <glm/glm.hpp>

#include "editor/clock.h"
#include "render/resolve.h"
#include "tools/viewer/tools/navigation.h"

namespace neuvv::viewer {

struct ToolMode;

constexpr const char* kLayerNames[] = {"colour", "alpha", "depth", "leaf level", "cost per ray"};  // by render::Show

// How the image is drawn.
struct ImageSettings {
    render::Show show = render::Show::kColour;
    float cost_max = 256;         // steps of a ray that are displayed brightest
    bool overrides_background = false;  // `background` in place of the stage's
    glm::vec3 background{0.2f};   // sRGB
    float max_scale = 1;          // rays per pixel along each side while something moves
    int samples = 2;              // rays per pixel along each side when nothing moves
};

// Which panels are open, and how large they are at scale 1.
struct PanelLayout {
    bool all = true;  // the side panels and the time line; Tab
    bool speed = false, help = false;
    float side_width = 320, timeline_height = 170;
    float tree_share = 0.33f;  // of the side's height
};

struct ViewState {
    Eye eye;
    editor::StageClock clock;
    ImageSettings image;
    PanelLayout panels;
    const ToolMode* mode = nullptr;  // what the pointer does in the image; never null
    bool snap = false;               // drags go in steps
    bool local_axes = false;         // handles stand along the node's own axes
    bool grid = false;               // lines on the floor
    bool along_path = false;         // the eye moves along the stage's camera path
    bool show_path = true;           // that path is drawn
};

}  // namespace neuvv::viewer
