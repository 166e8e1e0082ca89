// The fonts that travel in the program, as TrueType files: the window and images are drawn with the same letters.
#pragma once

#include <span>

namespace neuvv::ui {

std::span<const unsigned char> roboto_font();
std::span<const unsigned char> icon_font();

}  // namespace neuvv::ui
