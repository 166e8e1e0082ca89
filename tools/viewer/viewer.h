// The viewer: a window that shows a stage and edits it. It owns the parts below and runs the frame loop over them.
//
// A frame, in the order of Viewer::frame(): the input is read into a FrameInput; the clock moves on; keys act; panels
// and tools are drawn, and change the document, the view state and their own state; what changed is sent to the render
// thread. A panel is a function in panels/ or timeline/, a tool is a class in tools/. Both work with a Context
// (context.h) and take whatever else they use as arguments.
#pragma once

#include "tools/viewer/display.h"
#include "tools/viewer/editing_session.h"
#include "tools/viewer/eye_motion.h"
#include "tools/viewer/image_requests.h"
#include "tools/viewer/stage_sound.h"
#include "tools/viewer/tasks.h"

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
    void ask_to_close();
    void wait();
    void read_input();
    void frame();
    void apply_ui_scale();
    void draw_panels();
    void write_report();
    void store_preferences();

    std::string preferences_message_;
    Preferences preferences_;
    Display display_;
    EditingSession session_;
    ImageRequests images_;
    EyeMotion eye_motion_;
    StageSound sound_;
    Panels panels_;
    Tasks tasks_;
    bool may_close_ = false;  // unsaved edits and a verb that runs have been asked about
};

}  // namespace neuvv::viewer
