// Where the images of a render go, one after the other: into a video, or files of their own.
#pragma once

#include <optional>

#include "media/exr.h"
#include "media/image.h"
#include "media/video.h"
#include "tools/options.h"
#include "tools/render_record.h"

namespace neuvv::tools {

// Numbered images have a record beside them ("out_render.json" for out_%04d.png), so that `resume` goes on with those
// that an interrupted render left. A video can only go on where it was begun with `resume`: its images are then kept
// as PNGs in "out.mp4.frames/", which takes disk space and their encoding (some ms each), and they become the video at
// the end; without, they are encoded as they come, and nothing is kept of a render that is interrupted.
class ImageSink {
  public:
    // Throws InputError where `resume` would mix two renders.
    ImageSink(ImageOutput output, media::ImageSize size, double fps, RenderFacts facts, bool resume);

    // LabImage i is finished: an earlier run left it.
    bool has(uint32_t i) const;
    // What is finished when the render stops now can be gone on with.
    bool resumable() const { return !record_path_.empty(); }
    // Whether the images are to be linear.
    bool exr() const { return output_.exr; }

    // In order, each that it has not.
    void add(uint32_t i, const media::Image& image);
    void add(uint32_t i, const media::LinearImage& image);
    // After the last of `images`.
    void finish(uint32_t images);

  private:
    void record_finished(uint32_t i);
    ImageOutput output_;  // of kept images where the video is made of them at the end
    media::ImageSize size_;
    double fps_;
    std::filesystem::path video_path_;  // likewise; else empty
    std::optional<media::VideoWriter> video_;
    std::filesystem::path record_path_;  // empty: nothing is recorded
    RenderRecord record_;
};

}  // namespace neuvv::tools
