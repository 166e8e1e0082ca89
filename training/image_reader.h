// Images out of files and videos.
#pragma once

#include <filesystem>
#include <optional>

#include "media/video.h"
#include "training/rig.h"

namespace neuvv::training {

// Keeps the last video open: frames of one video asked for in rising order are decoded in one pass.
class ImageReader {
  public:
    // Throws InputError naming the file.
    media::Image read(const ImageSource& source);

  private:
    std::filesystem::path path_;
    std::optional<media::VideoReader> video_;
    int64_t next_frame_ = 0;
};

// By the file's header alone.
media::ImageSize size_of(const ImageSource& source);

}  // namespace neuvv::training
