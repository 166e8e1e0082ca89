// The viewer: a window that shows a stage and edits it.
//
// A frame: poll → FrameInput → keys → clock → panels and tools, which change the editor, the view and their own state →
// what changed goes to the render thread. A panel is a function in panels/ or timeline/, a tool a class in tools/; both
// work with a Context (context.h) and take what else they use as arguments.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "editor/shader_watch.h"
#include "tools/viewer/context.h"
#include "tools/viewer/exporter.h"
#include "tools/viewer/files.h"
#include "tools/viewer/frame_meter.h"
#include "tools/viewer/panels/panels.h"
#include "tools/viewer/screen.h"
#include "tools/viewer/screenshot.h"
#include "tools/viewer/timeline/timeline_state.h"
#include "tools/viewer/tools/tools.h"

namespace neuvv::viewer {

class Viewer {
  public:
    struct Options {
        std::string file;                // empty: an empty window
        std::optional<float> ui_scale;   // of panels; none: as the monitor and the preferences say
        std::filesystem::path report;    // empty: none
        std::optional<VkExtent2D> size;  // of the window; none: as it was last
        bool validate = false;
        std::filesystem::path screenshots;  // their folder; empty: where the user's pictures are
        std::filesystem::path shaders;      // sources that are watched; empty: none
    };
    Viewer(const Options& options, const std::string& device);
    Viewer(const Viewer&) = delete;
    Viewer& operator=(const Viewer&) = delete;
    ~Viewer();

    // Until the window is closed. Throws what ends the program.
    void run();

  private:
    void wait();
    void frame();
    void read_input();
    void take_notices();
    void take_stage();
    void set_title();
    void set_ui_scale();
    void take_keys();
    void take_key(const ui::KeyPress& press);
    void take_control_key(const ui::KeyPress& press);
    void move_eye();
    void draw_panels();
    void request_document();
    void request_view();
    void meter_latency(const FrameMeter::Numbers& before);
    void write_report();
    void store_preferences();
    double seconds() const;
    bool in_motion() const;
    bool image_is_sharp() const;
    FrameMeter::Numbers requested() const { return {view_request_ ? view_request_->id : 0, requested_document_}; }

    std::string preferences_message_;
    Preferences preferences_;
    ui::Window window_;
    gpu::Device device_;
    Screen screen_;
    Report report_;
    JobQueue jobs_;
    editor::RenderThread render_thread_;
    editor::Editor editor_;

    FrameInput input_;
    ViewState view_;
    FrameRequests requests_;
    Context context_{editor_, jobs_, render_thread_, report_, input_, view_, requests_};

    Exporter exporter_;
    Files files_;
    Screenshots screenshots_;
    editor::ShaderWatch shader_watch_;
    PaintTool paint_;
    Tools tools_{paint_};
    StageTree tree_;
    PropertiesPanel properties_;
    TimelineState timeline_;
    std::vector<editor::Notice> notices_;
    FrameMeter meter_;

    std::chrono::steady_clock::time_point begin_;
    std::optional<editor::ViewRequest> view_request_;  // the last one
    uint64_t requested_document_ = 0;                  // the last one that went to the render thread
    struct Flight {
        Eye from, to;
        double begin_s = 0;
    };
    std::optional<Flight> flight_;  // of the eye
    std::optional<Eye> path_eye_;   // where the camera path has put the eye
    std::string title_;
    bool may_close_ = false;
    std::vector<std::string> validation_messages_;
};

}  // namespace neuvv::viewer
