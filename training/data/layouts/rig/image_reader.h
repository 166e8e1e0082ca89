// Reads images from files and from videos.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "media/video.h"
#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

// Keeps the last video open, so that frames of one video that are read in ascending order are decoded in one pass.
class ImageReader {
  public:
    // Gets the size that the header says before pixels are decoded, so that a small file cannot take much memory; where
    // nobody knows the size, it must only have content (media::expect_content).
    using ExpectSize = std::function<void(media::ImageSize)>;
    // Throws InputError with the file, and what `expect_size` throws.
    media::Image read(const ImageSource& source, const ExpectSize& expect_size = {});

  private:
    std::filesystem::path path_;
    std::optional<media::VideoReader> video_;
    int64_t next_frame_ = 0;
};

// The size of the image, read from the file's header alone.
media::ImageSize size_of(const ImageSource& source);

}  // namespace neuvv::training
