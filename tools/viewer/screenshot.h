// Screenshots: what is seen, as PNG files.
#pragma once

#include <filesystem>

#include "tools/viewer/context.h"
#include "tools/viewer/screen.h"

namespace neuvv::viewer {

class Screenshots {
  public:
    // Empty: images_folder(). It is made with the first.
    explicit Screenshots(std::filesystem::path folder) : folder_(std::move(folder)) {}

    // The image without panels, as soon as it is sharp.
    void want_image() { image_ = true; }
    // All of the window, as it is.
    void want_window() { window_ = true; }

    // Each frame: takes what is wanted and there. Files are written off the window's thread; a notice names them.
    // `is_sharp`: the image that is displayed is final.
    void take(Context& context, Screen& screen, bool is_sharp);

  private:
    std::filesystem::path folder_;
    bool image_ = false, window_ = false, window_asked_ = false;
};

// $XDG_PICTURES_DIR, or Images in the home folder where there is one, or the working folder.
std::filesystem::path images_folder();

}  // namespace neuvv::viewer
