// The viewer: a window that shows a stage and edits it.
//
// A frame, in the order of Viewer::frame(): the input is read into a FrameInput; the clock moves on; keys act; panels
// and tools are drawn, and change the document, the view state and their own state; what changed is sent to the render
// thread. A panel is a function in panels/ or timeline/, a tool is a class in tools/. Both work with a Context
// (context.h) and take whatever else they use as arguments.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "base/platform.h"
#include "editor/draw/device_losses.h"
#include "editor/shader_watch.h"
#include "editor/sound_player.h"
#include "editor/waveforms.h"
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
        std::string file;                   // a stage, a clip or a folder of clips; empty: nothing is opened
        std::optional<float> ui_scale;      // of panels; nullopt: from the monitor and the preferences
        std::filesystem::path report;       // the file of the Report; empty: none
        std::optional<VkExtent2D> size;     // of the window; nullopt: its size when it was last closed
        bool validate = false;              // with the Vulkan validation layers
        std::filesystem::path screenshots;  // their folder; empty: images_folder()
        std::string trainee;            // whose motion is followed at once (motion::open_pose_source); empty: nobody
        std::filesystem::path shaders;  // the folder of sources that is watched; empty: none
    };
    // `device` selects the device as gpu::Device does. Throws RuntimeFailure where there is no display.
    Viewer(const Options& options, const std::string& device);
    Viewer(const Viewer&) = delete;
    Viewer& operator=(const Viewer&) = delete;
    ~Viewer();

    // Runs frames until the window is closed, then saves the preferences. What it throws ends the program; unsaved
    // edits have been stored for recovery by then.
    void run();

  private:
    void recover_device(std::string why);
    void round();
    void wait();
    void frame();
    void read_input();
    void take_notices();
    void receive_stage();
    void set_title();
    void apply_ui_scale();
    void handle_keys();
    void handle_key(const ui::KeyPress& press);
    void handle_control_key(const ui::KeyPress& press);
    void move_eye();
    void play_sound();
    void draw_panels();
    void request_document();
    void request_view();
    void meter_latency(const FrameMeter::Ids& before);
    void write_report();
    void store_preferences();
    double seconds() const;
    bool in_motion() const;
    bool image_is_sharp() const;
    FrameMeter::Ids requested() const { return {view_request_ ? view_request_->id : 0, requested_document_}; }

    std::string preferences_message_;
    Preferences preferences_;
    ui::Window window_;
    std::string device_choice_;
    gpu::Validation validation_;
    // These two are made anew, in the same place, where the device is lost.
    std::optional<gpu::Device> device_;
    std::optional<Screen> screen_;
    editor::DeviceLosses losses_;
    Report report_;
    JobQueue jobs_;
    editor::RenderThread render_thread_;
    editor::Editor editor_;

    FrameInput input_;
    ViewState view_;
    FrameRequests requests_;
    Context context_{editor_, jobs_, render_thread_, report_, input_, view_, requests_};

    Exporter exporter_;
    VerbTask verb_{device_choice_, program_file()};
    Files files_;
    Screenshots screenshots_;
    editor::ShaderWatch shader_watch_;
    PaintTool paint_;
    Tools tools_{paint_};
    StageTree tree_;
    PropertiesPanel properties_;
    TimelineState timeline_;
    Coaching coaching_;
    editor::SoundPlayer sound_player_;
    editor::Waveforms waveforms_{ui::Window::wake};
    std::vector<editor::Notice> notices_;
    FrameMeter meter_;

    std::chrono::steady_clock::time_point begin_;
    std::optional<editor::ViewRequest> view_request_;  // the last one that was sent to the render thread
    uint64_t requested_document_ = 0;                  // the Editor::id() of the last document that was sent there
    struct Flight {
        Eye from, to;
        double begin_s = 0;
    };
    std::optional<Flight> flight_;  // of the eye; nullopt: it does not fly
    std::optional<Eye> path_eye_;   // the eye that the camera path gave in the previous frame
    std::string title_;
    bool may_close_ = false;  // unsaved edits and a verb that runs have been asked about
    std::vector<std::string> validation_messages_;
};

}  // namespace neuvv::viewer
