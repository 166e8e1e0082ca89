// The panels. Each is a function in a file of its own name, which is called once a frame; its arguments are all that it
// uses.
#pragma once

#include <span>

#include "tools/viewer/coaching.h"
#include "tools/viewer/context.h"
#include "tools/viewer/exporter.h"
#include "tools/viewer/files.h"
#include "tools/viewer/frame_meter.h"
#include "tools/viewer/panels/stage_tree.h"
#include "tools/viewer/tools/paint_tool.h"
#include "tools/viewer/verbs/verb_task.h"

namespace neuvv::viewer {

struct MenuBar {
    Files& files;
    ui::Window& window;
    const Preferences& preferences;
    StageTree& tree;
    VerbTask& verb;
};
void menu_bar(Context& context, const MenuBar& uses);

// The tree of nodes, with buttons that add, duplicate and delete nodes.
void stage_panel(Context& context, const Area& area, StageTree& tree);

// What the fields of the properties tab display and the document does not contain.
struct PropertyFields {
    struct Angles {
        uint32_t node = 0;
        glm::dvec3 deg{0};
    } angles;  // as they were typed: other angles may mean the same rotation
    struct Time {
        std::optional<uint32_t> node;  // nullopt: no error
        uint64_t id = 0;               // of the document for which it was typed
        std::string typed, error;
    } time;              // a time map that was typed and is not valid
    bool evenly = true;  // all axes are scaled by the same factor
};

constexpr const char* kAlongPath = "along the camera path";

// What is exported, as selected in the panel.
struct ExportChoice {
    size_t kind = 0;  // 0: video; 1: numbered images; 2: one image
    media::ImageSize size{1920, 1080};
    std::string camera;  // of the stage, or kAlongPath; empty: the view of the window
    size_t range = 0;    // 0: the whole stage; 1: the range of the clock
    double fps = 0;      // 0: that of the stage
    size_t samples = 1;  // rays per pixel along each side, minus 1
    bool transparent = false;
};

// The panel with tabs for properties, paint, light and rendering.
struct PropertiesPanel {
    PropertyFields fields;
    ExportChoice export_choice;
    bool painted_before = false;  // painting was the mode of the previous frame
};
struct PropertiesUses {
    StageTree& tree;
    PaintTool& paint;
    Files& files;
    Exporter& exporter;
    Coaching& coaching;
};
// Opens the tab of paint when painting becomes the mode.
void properties_panel(Context& context, const Area& area, PropertiesPanel& state, const PropertiesUses& uses);
// The tabs, in files of their own.
void properties_tab(Context& context, PropertyFields& fields, StageTree& tree);
void paint_tab(Context& context, PaintTool& paint, Files& files);
void light_tab(Context& context, StageTree& tree);
void coach_tab(Context& context, Coaching& coaching);
void render_tab(Context& context, ExportChoice& choice, Files& files, Exporter& exporter);

// Asks for what a verb of `neuvv` needs, and shows how far it is. Draws nothing while it is closed.
void verb_dialog(Context& context, VerbTask& task, Files& files);

// How long images and passes take, and what is drawn.
void statistics_panel(Context& context, const gpu::Device& device, const FrameMeter& meter);
// The list of keys.
void help_panel(Context& context);
// What the program is, the guide and the licence, each in a window of its own where it is open.
void about_panels(Context& context, const gpu::Device& device);
// The notices that are displayed: each for some seconds.
class Notices {
  public:
    // To be called once a frame: takes those of the editor. While nothing is open, errors stay: they say why nothing
    // could be opened.
    void take(const Context& context);
    std::span<const editor::Notice> all() const { return all_; }

  private:
    std::vector<editor::Notice> all_;
};
// Notices, jobs that are under way, and problems of the render thread, at the bottom of the image.
void notices_panel(Context& context, std::span<const editor::Notice> notices);

// Begins the ImGui window of a panel at this area; ImGui::End() ends it.
bool begin_panel(const char* name, const Area& area);
// Where a row of the current ImGui window is not visible, scrolls it to the centre. `top` is in pixels from the top of
// the first row.
void scroll_to_row(float top, float height);

}  // namespace neuvv::viewer
