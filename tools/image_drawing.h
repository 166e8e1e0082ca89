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

// The height of a line of text in pixels, from the top of the highest letter to the bottom of the lowest.
constexpr int kTextHeight = 15;
// Draws UTF-8 in the letters of the window; (x, y) is the top left corner in pixels.
void draw_text(media::Image& image, int x, int y, const std::string& text, const Colour& colour,
               int height = kTextHeight);
// In pixels.
double text_width(const std::string& text, int height = kTextHeight);

}  // namespace neuvv::tools
