// How panels look: letters, signs, colours, distances.
#pragma once

#include <volk.h>

struct ImVec4;

namespace neuvv::viewer {

// Makes ImGui's style and letters anew, `scale` times as large as at 96 dots an inch.
void apply_look(float scale);

// What lies under panels and pictures.
VkClearColorValue ground_colour();

constexpr float kLetterPixels = 15;  // at scale 1

// Colours with a meaning, as ImGui packs them (ABGR).
constexpr unsigned kAccent = 0xffe8a33d, kAccentDim = 0x80e8a33d, kWarning = 0xff35b5f0, kError = 0xff5a5af0,
                   kGood = 0xff7ecb6a, kFaint = 0xff8a8580, kGroove = 0xff1b1917;

}  // namespace neuvv::viewer
