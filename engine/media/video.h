// Video by libav*. It writes .mp4 (H.264 where the installed FFmpeg has an encoder for it, else MPEG-4 part 2), 4:2:0,
// without alpha; and .mov (ProRes 4444: 4:4:4, 10 bits, straight alpha). It reads the first video stream of .mp4, .mov,
// .mkv, .webm or .avi with any codec.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "media/image.h"

namespace neuvv::media {

// The size of a video's side: encoders require even sizes, so an odd side gets one more row or column.
inline uint32_t video_side(uint32_t side) {
    return side + side % 2;
}

class VideoWriter {
  public:
    // The sides of the video are video_side() of these; the last row or column is repeated. Frames are written to a
    // temporary file beside `path`, which finish() renames. Throws RuntimeFailure where no encoder or muxer can be
    // opened.
    VideoWriter(const std::filesystem::path& path, uint32_t width, uint32_t height, double fps);
    ~VideoWriter();  // without finish(), the temporary file is removed
    VideoWriter(VideoWriter&&) noexcept;
    VideoWriter& operator=(VideoWriter&&) noexcept;

    // Adds a frame of this size. An .mp4 ignores alpha: composite first. Throws RuntimeFailure.
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

    ImageSize size() const;       // as shown: turned as the file says
    double pixel_aspect() const;  // how much wider than high its pixels are to be shown
    uint32_t frames() const;      // those shown, by the file's index, or where it has none by counting packets
    double fps() const;           // the average; 0: unknown
    // What the file says about how it is shown, in words, that is not usual: what is done about it, or is not.
    std::vector<std::string> notes() const;

    // Reads the next frame in order of display; returns false at the end. Frames that an edit list cuts off are left
    // out. The image is turned as the file says, and opaque unless the video has an alpha plane. The colour matrix is
    // that of the stream; where it names none, BT.709 from 720 lines on and BT.601 below. HLG, PQ and wide gamuts
    // become sRGB (video_colour.h). Pixels that are not square are not scaled. Throws InputError for a damaged frame, a
    // change of size, and a file that ends before frames().
    bool next(Image& frame);
    // Skips a frame; cheaper than next(), with the same checks.
    bool skip();

  private:
    struct State;
    std::unique_ptr<State> state_;
};

// Writes the videos one after the other into one, without encoding them again. They must be of VideoWriters with the
// same encoder, size and rate. `path`, which gets the comment, is replaced when all of it is written. Throws
// InputError, which names the part that is damaged or was encoded otherwise, and RuntimeFailure. `parts` must not be
// empty.
void join_videos(const std::vector<std::filesystem::path>& parts, const std::filesystem::path& path,
                 const std::string& comment = "");

// A video's comment; empty where it has none, or is no video.
std::string comment_of_video(const std::filesystem::path& path);

// Size, number of frames and frame rate of a video, found by decoding all of it. Throws InputError.
struct VideoSummary {
    uint32_t width = 0;
    uint32_t height = 0;
    uint32_t frames = 0;
    double fps = 0;
};
VideoSummary summarise_video(const std::filesystem::path& path);

}  // namespace neuvv::media
