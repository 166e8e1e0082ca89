// A render that several processes share: each renders a part of its images.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "base/file_lock.h"
#include "media/image_sink.h"
#include "tools/ranks.h"

namespace neuvv::tools {

// Which part of how many, from 1 on.
struct PartNumber {
    uint32_t part = 1, parts = 1;
};

// The part that --part names, written "2/8"; where it is empty, that of a process that mpirun or srun started with
// others. Throws InputError.
PartNumber part_number(const std::string& text, const Ranks& ranks);

// The images of the part.
media::ImageRange images_of(const PartNumber& number, uint32_t images);

// Throws InputError where there are fewer images than parts.
void expect_enough_images(const PartNumber& number, uint32_t images);

// The folder in which the parts of a render have what they share until it is whole: parts of a video, a job's script
// and logs. It lies beside the video (out.mp4.parts) or the numbered images (out_render.parts).
std::filesystem::path folder_of_parts(const media::ImageOutput& whole);

// The part of a render that this process has: all of it, or a part as other processes have the others. Parts of a video
// are videos, whose names also say what they depend on, so that two renders do not mix. Numbered images lie where those
// of the whole render would.
class RenderPart {
  public:
    // Of a part of a video, creates the folder of parts, and without `resume` removes what an earlier run may have left
    // of this part. Throws InputError where there are fewer images than parts, and where another process renders this
    // part of a video; RuntimeFailure where the folder's file system has no locks.
    RenderPart(PartNumber number, media::ImageOutput whole, const media::RenderFacts& facts, uint32_t images,
               bool resume);

    // What is done to the whole video, once all of its images are there: with several parts, before it is seen under
    // its name.
    using FinishVideo = std::function<void(const std::filesystem::path& video)>;
    void finish_with(FinishVideo finish) { finish_ = std::move(finish); }
    // Call it when the part is written. It does that where the part is the whole.
    void finish_whole() const;

    media::ImageOutput output() const;
    std::optional<media::ImageRange> range() const;  // nothing where the part is the whole
    uint32_t first() const { return images_of(number_, images_).first; }
    uint32_t end() const { return images_of(number_, images_).end; }

    // Whether an earlier process has written this part of a video, or all parts are joined already.
    bool is_there() const;
    // Call it when this part is written. The process that finds all parts of a video joins them, and removes them.
    // Returns what became of the part, for the user; nothing where it is the whole.
    std::string join_if_complete() const;

  private:
    std::string ending() const { return whole_.path.extension().string(); }
    bool is_part_of_video() const { return number_.parts > 1 && whole_.kind == media::ImageOutput::Kind::kVideo; }
    std::filesystem::path video_of(uint32_t part) const;
    std::filesystem::path lock_of_join() const;
    bool is_joined() const;
    uint32_t missing() const;
    void join() const;

    PartNumber number_;
    media::ImageOutput whole_;
    std::string facts_hash_;
    uint32_t images_;
    std::optional<FileLock> lock_;  // of this part of a video
    FinishVideo finish_;
};

}  // namespace neuvv::tools
