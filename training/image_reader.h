// Reads images from files and from videos.
#pragma once

#include <filesystem>
#include <optional>

#include "media/video.h"
#include "training/layouts/rig.h"

namespace neuvv::training {

// Keeps the last video open, so that frames of one video that are read in ascending order are decoded in one pass.
class ImageReader {
  public:
    // Throws InputError with the file.
    media::Image read(const ImageSource& source);

  private:
    std::filesystem::path path_;
    std::optional<media::VideoReader> video_;
    int64_t next_frame_ = 0;
};

// The size of the image, read from the file's header alone.
media::ImageSize size_of(const ImageSource& source);

}  // namespace neuvv::training
