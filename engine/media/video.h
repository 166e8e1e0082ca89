// Video out: an .mp4 (H.264 where the installed FFmpeg has it, else MPEG-4 part 2), 4:2:0, through libav*.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "media/image.h"

namespace neuvv {

class VideoWriter {
  public:
    // Odd sizes are padded by one row or column. Frames go to a temporary beside `path`, renamed by finish().
    // Throws RuntimeFailure where no encoder or muxer can be opened.
    VideoWriter(const std::filesystem::path& path, uint32_t width, uint32_t height, double fps);
    ~VideoWriter();  // without finish(), the temporary is removed
    VideoWriter(VideoWriter&&) noexcept;
    VideoWriter& operator=(VideoWriter&&) noexcept;

    // Alpha is ignored: composite first.
    void add(const Image& frame);
    void finish();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

// What a video file holds, by decoding it whole; used by tests and `neuvv info`. Throws InputError.
struct VideoSummary {
    uint32_t width = 0;
    uint32_t height = 0;
    uint32_t frames = 0;
    double fps = 0;
};
VideoSummary summarise_video(const std::filesystem::path& path);

}  // namespace neuvv
