// The panels: each is a function in a file of its own name, called once a frame, that takes what it uses.
#pragma once

#include <span>

#include "tools/viewer/context.h"
#include "tools/viewer/exporter.h"
#include "tools/viewer/files.h"
#include "tools/viewer/frame_meter.h"
#include "tools/viewer/panels/stage_tree.h"
#include "tools/viewer/tools/paint_tool.h"

namespace neuvv::viewer {

struct MenuBar {
    Files& files;
    ui::Window& window;
    const Preferences& preferences;
    StageTree& tree;
};
void menu_bar(Context& context, const MenuBar& uses);

// The tree of nodes.
void stage_panel(Context& context, const Area& area, StageTree& tree);

// What fields display that the document does not say in these words.
struct PropertyFields {
    struct Angles {
        uint32_t node = 0;
        glm::dvec3 deg{0};
    } angles;  // as they were typed: other angles mean the same rotation
    struct Time {
        std::optional<uint32_t> node;  // none: nothing is wrong
        uint64_t id = 0;               // of the document that it was typed for
        std::string typed, error;
    } time;
    bool evenly = true;  // scale all axes alike
};

constexpr const char* kAlongPath = "along the camera path";

// What is exported, as selected in the panel.
struct ExportChoice {
    size_t kind = 0;  // video, numbered images, one image
    media::ImageSize size{1920, 1080};
    std::string camera;  // of the stage, or kAlongPath; empty: the window's view
    size_t range = 0;    // the whole stage, or the clock's range
    double fps = 0;      // 0: the stage's
    size_t samples = 1;  // rays along a pixel's side, less one
    bool transparent = false;
};

// The tabs: properties of what is selected, paint, light, rendering.
struct PropertiesPanel {
    PropertyFields fields;
    ExportChoice export_choice;
    bool painted_before = false;  // the tool of the last frame was the brush
};
struct PropertiesUses {
    StageTree& tree;
    PaintTool& paint;
    Files& files;
    Exporter& exporter;
};
void properties_panel(Context& context, const Area& area, PropertiesPanel& state, const PropertiesUses& uses);
// Its tabs, in files of their own.
void properties_tab(Context& context, PropertyFields& fields, StageTree& tree);
void paint_tab(Context& context, PaintTool& paint, Files& files);
void light_tab(Context& context, StageTree& tree);
void render_tab(Context& context, ExportChoice& choice, Files& files, Exporter& exporter);

void speed_panel(Context& context, const gpu::Device& device, const FrameMeter& meter);  // how long images take
void help_panel(Context& context);                                                       // the keys
// Notices, and what is under way.
void notices_panel(Context& context, std::span<const editor::Notice> notices);

// A panel of the fixed layout: begins an ImGui window there, ImGui::End() ends it.
bool begin_panel(const char* name, const Area& area);

}  // namespace neuvv::viewer
