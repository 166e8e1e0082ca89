// The display: the window with its events, and the device and the screen that draw into it. The latter two are made
// anew where the device is lost.
#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "editor/draw/device_losses.h"
#include "tools/viewer/frame_input.h"
#include "tools/viewer/screen.h"
#include "tools/viewer/screenshot.h"

namespace neuvv::viewer {

struct DisplayOptions {
    ui::WindowGeometry geometry;
    std::optional<float> ui_scale;  // of panels; nullopt: `scale_on_monitor` times that of the window's monitor
    double scale_on_monitor = 1;
    std::string device;                 // as gpu::Device has it
    bool validate = false;              // with the Vulkan validation layers
    std::filesystem::path screenshots;  // as Screenshots has it
};

class Display {
  public:
    // Throws RuntimeFailure where there is no display.
    explicit Display(const DisplayOptions& options);

    ui::Window window;
    Screenshots screenshots;

    const gpu::Device& device() const { return *device_; }
    Screen& screen() { return *screen_; }
    // Makes the device anew, and the screen, each in its place. All else that is on the device must have been freed.
    // Throws RuntimeFailure as DeviceLosses::note.
    void make_anew(std::string why);

    double seconds() const;  // since the window was opened
    // Takes the next portion of events: time, keys and characters. Returns whether there was any event.
    bool read(FrameInput& input);
    // Begins a frame of panels, and notes which keys slow down or speed up a flight.
    void begin(FrameInput& input);
    // Presents the panels over the newest image. Returns false where another frame has to be drawn.
    bool end(const FrameInput& input);

    void set_title(std::string title);
    const std::string& title() const { return title_; }
    // The first messages of the validation layers.
    const std::vector<std::string>& validation_messages();

  private:
    std::string device_choice_;
    gpu::Validation validation_;
    std::optional<gpu::Device> device_;
    std::optional<Screen> screen_;
    editor::DeviceLosses losses_;
    std::chrono::steady_clock::time_point begin_;
    std::string title_;
    std::vector<std::string> validation_messages_;
};

}  // namespace neuvv::viewer
