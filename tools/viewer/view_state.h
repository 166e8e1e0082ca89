// How the user looks at the stage: settings of the viewer, which are not saved with the stage.
#pragma once

#include <glm/glm.hpp>
#include <set>
#include <string>

#include "editor/clock.h"
#include "render/rays/resolve.h"
#include "tools/viewer/tools/navigation.h"

namespace neuvv::viewer {

struct Preferences;
struct ToolMode;

constexpr const char* kLayerNames[] = {"colour", "alpha", "depth", "leaf level", "cost per ray"};  // by render::Show

// How the image is drawn.
struct ImageSettings {
    render::Show show = render::Show::kColour;
    float cost_max = 256;               // of kCost: the number of steps of a ray that is displayed as white
    bool overrides_background = false;  // `background` replaces that of the stage
    glm::vec3 background{0.2f};         // sRGB
    float max_scale = 1;                // the most rays per pixel along each side while something moves
    int samples = 2;                    // rays per pixel along each side while nothing moves
    bool far_levels = true;             // draw far performers from coarser levels (FrameSettings::far_levels)
};

// Which panels are open, and how large they are at scale 1.
struct PanelLayout {
    bool all = true;  // the side panels and the timeline are displayed (Tab)
    bool statistics = true, pass_times = false;
    bool help = false, about = false, guide = false, licence = false;
    float side_width = 320, timeline_height = 170;
    float tree_share = 0.33f;  // the stage panel's share of the height of the side panels
};

struct ViewState {
    Eye eye;
    editor::StageClock clock;
    ImageSettings image;
    PanelLayout panels;
    const ToolMode* mode = nullptr;  // what the pointer does in the image; never null
    bool snap = false;               // drags of handles move in steps
    bool local_axes = false;         // handles lie along the axes of the node, not of the world
    bool grid = false;               // a grid of lines is drawn on the floor
    bool axes = true;                // the directions of the axes are drawn in a corner of the image
    bool along_path = false;         // the eye follows the camera path of the stage
    bool show_path = true;           // the camera path is drawn over the image
    // Performers are heard while the clock runs, but for those of `muted`; or this one alone, unless `solo` is empty.
    // By the names of their nodes.
    bool sound = true;
    std::set<std::string> muted;
    std::string solo;

    bool hears(const std::string& performer) const {
        return sound && (solo.empty() ? !muted.contains(performer) : performer == solo);
    }
    // As a click on the performer's sign does it: with Shift the performer is heard alone, or no more.
    void toggle_sound(const std::string& performer, bool alone) {
        if (alone)
            solo = solo == performer ? "" : performer;
        else if (!muted.erase(performer))
            muted.insert(performer);
    }
};

// Takes over what the preferences keep of the view, and writes it back there.
void apply_preferences(ViewState& view, const Preferences& preferences);
void note_preferences(const ViewState& view, Preferences& preferences);

}  // namespace neuvv::viewer
