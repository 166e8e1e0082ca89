// Lines and names on images.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <string>

#include "media/image.h"

namespace neuvv::tools {

using Colour = std::array<uint8_t, 3>;  // sRGB

// Sets the colour of the pixel at (x, y), not its alpha. Outside of the image it does nothing.
void set_pixel(media::Image& image, double x, double y, const Colour& colour);

// Ends included, in pixels from the top left; what falls outside is left out.
void draw_line(media::Image& image, glm::dvec2 from, glm::dvec2 to, const Colour& colour, int width = 1);

// Pixels of a character, the gap to the next one included in its width.
constexpr uint32_t kGlyphWidth = 8, kGlyphHeight = 10;
// Draws capitals, digits and a few other characters; (x, y) is the top left corner in pixels. Small letters become
// capitals, anything else a question mark.
// `dot` is the size of a glyph's dots; the constants above are for the default.
void draw_text(media::Image& image, int x, int y, const std::string& text, const Colour& colour, int dot = 2);

}  // namespace neuvv::tools
