// Values of what a user writes on the command line. All functions that parse throw InputError, which names the option
// and the fix.
#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "media/image.h"

namespace neuvv::tools {

// Sizes of the images of a clip and of a stage where the user gives none.
constexpr media::ImageSize kClipSize{720, 720}, kStageSize{1280, 720};

// "1280x720"; each side from 1 to media::kMaxImageSide pixels.
media::ImageSize parse_size(const std::string& text);

// "1,-2.5,3e-2": `count` numbers of at most 1e9. `fix` is for the error: how the numbers are written.
std::vector<double> parse_numbers(const std::string& option, const std::string& text, size_t count,
                                  const std::string& fix);

// A number of frames, or a place in a clip: frames ("24"), seconds ("1.5s"), or minutes and seconds ("2:10") at `fps`
// frames a second (0: not known), rounded. Throws InputError.
uint32_t parse_frames(const std::string& option, const std::string& text, double fps);

// Linear RGB and opacity of a colour: "#rrggbb" or "rrggbb" (sRGB), one of CSS's sixteen basic names, "grey" or
// "clear". `option` is for the error.
glm::vec4 parse_colour(const std::string& option, const std::string& text);

// First and last frame of a clip that are shown; fractions lie between two frames.
struct FrameRange {
    double first = 0, last = 0;
};
// "a:b", "a:", ":b" or "a"; an empty text is the whole clip, which has `frames` frames.
FrameRange parse_frame_range(const std::string& text, uint32_t frames);

}  // namespace neuvv::tools
