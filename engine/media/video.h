// Video through libav*. Out: an .mp4 (H.264 where the installed FFmpeg has it, else MPEG-4 part 2), 4:2:0. In: the
// first video stream of .mp4, .mov, .mkv, .webm or .avi, whatever its codec.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "media/image.h"

namespace neuvv::media {

// Encoders want even sizes: odd ones are padded by one row or column.
inline uint32_t video_side(uint32_t side) {
    return side + side % 2;
}

class VideoWriter {
  public:
    // Of video_side() sizes, by repeating the last row or column. Frames go to a temporary beside `path`, renamed by
    // finish(). Throws RuntimeFailure where no encoder or muxer can be opened.
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

class VideoReader {
  public:
    // Throws InputError where the file cannot be opened as a video.
    explicit VideoReader(const std::filesystem::path& path);
    ~VideoReader();
    VideoReader(VideoReader&&) noexcept;
    VideoReader& operator=(VideoReader&&) noexcept;

    ImageSize size() const;
    uint32_t frames() const;  // as its index says, or where it has none by counting packets
    double fps() const;       // 0: unknown

    // The next frame in order of display; false at the end. Opaque unless the video has an alpha plane. The matrix is
    // the stream's, where it names none that of BT.709 from 720 lines on, below of BT.601. Throws InputError for a
    // damaged frame, a change of size, and a file that ends before frames().
    bool next(Image& frame);
    // Passes over a frame: cheaper than next(), and it checks the same.
    bool skip();

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

}  // namespace neuvv::media
