// A render that several processes share: each renders a part of its images.
#pragma once

#include <string>

#include "media/image_sink.h"
#include "tools/ranks.h"

namespace neuvv::tools {

// Which part of all parts, from 1 on.
struct RenderPart {
    uint32_t part = 1, parts = 1;
};

// The part that --part names, written "2/8"; where it is empty, that of a process that mpirun or srun started with
// others. Throws InputError.
RenderPart part_of(const std::string& text, const Ranks& ranks);

// The folder beside a video in which its parts lie until they are joined.
std::filesystem::path folder_of_parts(const std::filesystem::path& video);

// What a process renders, and where it puts it. Parts of a video lie in a folder beside it, "out.mp4.parts", under
// names that also say what they depend on, so that two renders do not mix. Numbered images lie where the whole
// render's would.
class RenderShare {
  public:
    // Creates the folder of parts. Throws InputError where the output is a single image, or has fewer images than there
    // are parts.
    RenderShare(RenderPart part, media::ImageOutput whole, const media::RenderFacts& facts, uint32_t images);

    media::ImageOutput output() const;
    media::ImageRange range() const;  // no end where the share is the whole
    uint32_t first() const { return static_cast<uint32_t>(uint64_t{images_} * (part_.part - 1) / part_.parts); }
    uint32_t end() const { return static_cast<uint32_t>(uint64_t{images_} * part_.part / part_.parts); }

    // Whether an earlier process has written this part of a video.
    bool is_there() const;
    // Call it when the part is written. The process that finds all parts of a video joins them, and removes them.
    // Returns what to tell the user; nothing where the share is the whole.
    std::string conclude() const;

  private:
    std::filesystem::path folder() const { return folder_of_parts(whole_.path); }
    std::filesystem::path video_of(uint32_t part) const;
    bool is_video() const { return whole_.kind == media::ImageOutput::Kind::kVideo; }
    uint32_t missing() const;
    void join() const;

    RenderPart part_;
    media::ImageOutput whole_;
    std::string content_;  // a hash of what the images depend on
    uint32_t images_;
};

}  // namespace neuvv::tools
