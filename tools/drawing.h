// Lines and small letters on an image.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <string>

#include "media/image.h"

namespace neuvv::tools {

using Colour = std::array<uint8_t, 3>;  // sRGB

media::Image blank(uint32_t width, uint32_t height, const Colour& colour);

// One pixel wide, ends included, in pixels from the top left; what falls outside is left out.
void draw_line(media::Image& image, glm::dvec2 from, glm::dvec2 to, const Colour& colour);

constexpr uint32_t kLetterWidth = 8, kLetterHeight = 10;  // of a character, the gap to the next included in the width

// Capitals, digits and a few signs, from its top left corner; anything else is a question mark.
void draw_text(media::Image& image, int x, int y, const std::string& text, const Colour& colour);

}  // namespace neuvv::tools
