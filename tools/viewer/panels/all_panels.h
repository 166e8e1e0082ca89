// All panels, and the tools in the image, with the state that they keep from frame to frame.
#pragma once

#include "editor/waveforms.h"
#include "tools/viewer/panels/panels.h"
#include "tools/viewer/timeline/timeline_state.h"
#include "tools/viewer/tools/tools.h"

namespace neuvv::viewer {

// What panels use and do not own.
struct PanelUses {
    ui::Window& window;
    const gpu::Device& device;
    const Preferences& preferences;
    Files& files;
    Exporter& exporter;
    VerbTask& verb;
    Coaching& coaching;
    editor::Waveforms& waveforms;
    const FrameMeter& meter;
};

struct Panels {
    explicit Panels(const gpu::Device& device) : paint(device) {}
    Panels(const Panels&) = delete;
    Panels& operator=(const Panels&) = delete;

    // Draws the panels and lets them and the tools act: the image at the left, the stage and the properties at the
    // right, the timeline below the image. Writes into `input` where the image lies, and its camera.
    void draw(Context& context, FrameInput& input, const PanelUses& uses);
    // For a document that was opened in place of another.
    void document_opened();

    PaintTool paint;
    Tools tools{paint};
    StageTree tree;
    PropertiesPanel properties;
    TimelineState timeline;
    Notices notices;
};

}  // namespace neuvv::viewer
