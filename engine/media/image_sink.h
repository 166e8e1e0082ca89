// Where the images of a render go, one after the other: into a video, or files of their own. A record beside numbered
// images says all that they depend on, and how many are finished: an interrupted render goes on by it, and two
// different renders are not mixed. Images are encoded by threads of the sink, while the caller draws the next ones.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include "base/threads/workers.h"
#include "media/deep_exr.h"
#include "media/exr.h"
#include "media/image.h"
#include "media/video.h"

namespace neuvv::media {

// A path for images, as a user writes it.
struct ImageOutput {
    enum class Kind { kVideo, kNumberedImages, kImage } kind = Kind::kVideo;
    std::filesystem::path path;  // a pattern for kNumberedImages
    bool exr = false;            // linear light and depth, not sRGB
    bool has_deep = false;       // whether each .exr has a deep one beside it

    // Whether images may be transparent there. Of videos, only ProRes 4444 (.mov) has alpha.
    bool holds_alpha() const;
    // The file of image i.
    std::filesystem::path file(uint32_t i) const;
    // The pattern's file with this text in place of the number; the path itself where it is no pattern.
    std::filesystem::path file(const std::string& in_place_of_number) const;
    // The deep file of image i: out_deep_0001.exr beside out_0001.exr, out_deep.exr beside out.exr.
    std::filesystem::path deep_file(uint32_t i) const;
};
// "out.mp4", "out.mov", "out_%04d.png", "out.png", or the same as .exr.
ImageOutput parse_output(const std::string& text);

// What images depend on, by the name that a user knows it by: an option, or the scene.
using RenderFacts = std::map<std::string, std::string>;

// "xxh3:…" of a file's content: the same wherever the file lies and whenever it was written. Throws InputError.
std::string content_fact(const std::filesystem::path& file);

// Images of a render, by their numbers: from `first` to before `end`.
struct ImageRange {
    uint32_t first = 0, end = 0;
};

// Removes the records of renders into numbered images, so that a render with `resume` begins anew. Other outputs have
// none.
void forget_renders(const ImageOutput& output);

// Numbered images have a record beside them ("out_render.json" for out_%04d.png; of a part of the images,
// "out_render_0-25.json"), so that `resume` goes on with those that an interrupted render left. A video can only go on
// where it was begun with `resume`: its images are then kept as PNGs in "out.mp4.frames/", which takes disk space and
// their encoding (some ms each), and they become the video at the end. Without `resume` they are encoded as they come,
// and nothing is kept of a render that is interrupted.
class ImageSink {
  public:
    // `range`: the images that the sink gets of a render that several processes share; nothing: all. Throws InputError
    // where `resume` would mix two renders.
    ImageSink(ImageOutput output, ImageSize size, double fps, RenderFacts facts, bool resume,
              std::optional<ImageRange> range = std::nullopt);
    // Without finish(), waits for the images that were added; a video is removed without that.
    ~ImageSink();

    // Whether an earlier run has finished image i.
    bool has(uint32_t i) const;
    // Whether a render that stops now can be resumed.
    bool resumable() const { return !record_path_.empty(); }
    // Whether the images are to be linear.
    bool exr() const { return output_.exr; }

    // Adds an image that the sink does not have yet; call it in order of i. It waits only where another image waits
    // until a thread can write it. Throws what went wrong with an earlier image: RuntimeFailure.
    void add(uint32_t i, Image image);
    // `deep` must be given where the output has deep files (assert).
    void add(uint32_t i, LinearImage image, std::optional<DeepImage> deep = std::nullopt);
    // Waits until the images that were added are written. Throws as add() does.
    void wait();
    // After the last image, whose number is end − 1: waits until all are written. `complete` is called when the video
    // is there, while an interrupted run could still make it again. Throws as add() does.
    void finish(uint32_t end, const std::function<void()>& complete = {});
    // How many images of an earlier, longer render finish() removed: those behind its end, so that the two do not mix.
    uint32_t removed() const { return removed_; }

  private:
    void open_record(bool resume, const std::optional<ImageRange>& range);
    void write(uint32_t i, std::function<void()> image);
    void record_finished(uint32_t i);
    ImageOutput output_;  // of kept images where the video is made of them at the end
    ImageSize size_;
    double fps_;
    std::filesystem::path video_path_;  // of a video that is made at the end; else empty
    std::optional<VideoWriter> video_;
    std::filesystem::path record_path_;  // empty: nothing is recorded
    RenderFacts facts_;
    uint32_t first_;       // the number of the sink's first image
    uint32_t before_ = 0;  // the same of an earlier render that this one replaces
    uint32_t removed_ = 0;
    uint32_t had_;                      // the number after that of the last image of an earlier run
    std::mutex mutex_;                  // guards the next two, which the workers write
    uint32_t finished_;                 // all images with lower numbers are written
    std::set<uint32_t> written_ahead_;  // the numbers of images from finished_ on that are written
    std::optional<Workers> workers_;    // the last member, as its threads use the others
};

}  // namespace neuvv::media
