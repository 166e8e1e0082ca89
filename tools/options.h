// What a user writes on the command line, as values. Everything here throws InputError naming the option and the fix.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "media/image.h"

namespace neuvv::tools {

// Of a clip and of a stage, where nobody says otherwise.
constexpr media::ImageSize kClipSize{720, 720}, kStageSize{1280, 720};

// "1280x720".
media::ImageSize parse_size(const std::string& text);

// "1,-2.5,3e-2": so many numbers of at most 1e9. `fix` says how they are written.
std::vector<double> parse_numbers(const std::string& option, const std::string& text, size_t count,
                                  const std::string& fix);

// Linear RGB and opacity of one of CSS's sixteen basic names, "grey", "clear", "#rrggbb" or "rrggbb" (sRGB). `option`
// is for the error.
glm::vec4 parse_colour(const std::string& option, const std::string& text);

// First and last frame of the clip, fractions allowed.
struct FrameRange {
    double first = 0, last = 0;
};
// "a:b", "a:", ":b", "a" or empty for the whole clip of `frames` frames.
FrameRange parse_frame_range(const std::string& text, uint32_t frames);

// Where the images of a render go.
struct ImageOutput {
    enum class Kind { kVideo, kNumberedImages, kImage } kind = Kind::kVideo;
    std::filesystem::path path;  // a pattern for kNumberedImages
    bool exr = false;            // linear light and depth, not sRGB

    // The file of image i.
    std::filesystem::path file(uint32_t i) const;
    // The pattern's file with a word in place of the number; the path itself where there is no number.
    std::filesystem::path file(const std::string& word) const;
};
// "out.mp4", "out_%04d.png", "out.png", or the same as .exr.
ImageOutput parse_output(const std::string& text);

// Called before any work, so that it is not done in vain: makes the folder (or the file's folder, which may be the
// working one) where it is missing, and expects that it can be written into. `option` is for the error.
void prepare_output_folder(const std::string& option, const std::filesystem::path& folder);
void prepare_output_file(const std::string& option, const std::filesystem::path& file);
// Writes a whole file, atomically. Throws RuntimeFailure.
void write_text_file(const std::filesystem::path& file, const std::string& text);

}  // namespace neuvv::tools
