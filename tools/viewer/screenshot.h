// Screenshots of the image or of the window, as PNG files.
#pragma once

#include <filesystem>
#include <utility>

#include "tools/viewer/context.h"
#include "tools/viewer/screen.h"

namespace neuvv::viewer {

class Screenshots {
  public:
    // An empty path stands for images_folder(). The folder is created with the first screenshot.
    explicit Screenshots(std::filesystem::path folder) : folder_(std::move(folder)) {}

    // Requests the image without panels. It is taken once the image is sharp.
    void request_image() { image_ = true; }
    // Requests the window with its panels, as it is.
    void request_window() { window_ = true; }

    // For a screen that was made anew: it has forgotten what it was to capture.
    void request_again() { window_ |= std::exchange(window_capture_pending_, false); }

    // To be called once a frame. Takes the requested screenshots that can be taken now. The job queue writes the files,
    // and a notice names each. `is_sharp`: the displayed image is final.
    void take(Context& context, Screen& screen, bool is_sharp);

  private:
    std::filesystem::path folder_;
    bool image_ = false, window_ = false, window_capture_pending_ = false;
};

// $XDG_PICTURES_DIR; else the folder Pictures in the home folder, where that exists; else the working folder.
std::filesystem::path images_folder();

}  // namespace neuvv::viewer
