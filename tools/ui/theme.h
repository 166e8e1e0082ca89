// The look of all panels: fonts, colours, distances.
#pragma once

#include <volk.h>

struct ImVec4;

namespace neuvv::ui {

// Sets ImGui's style and loads its fonts, `scale` times as large as at 96 dots an inch.
void apply_theme(float scale);

// The colour behind panels and images.
VkClearColorValue background_colour();

constexpr float kFontPixels = 15;  // at scale 1

// Colours with a meaning, as ImGui packs them (ABGR).
constexpr unsigned kAccent = 0xffe8a33d, kAccentDim = 0x80e8a33d, kWarning = 0xff35b5f0, kError = 0xff5a5af0,
                   kGood = 0xff7ecb6a, kFaint = 0xff8a8580, kGroove = 0xff1b1917;

}  // namespace neuvv::ui
