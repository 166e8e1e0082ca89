// Shadows that the performer casts on a known background: they darken it, keep its hue, and begin gradually.
#pragma once

#include <array>
#include <vector>

#include "training/tree/pixel_mask.h"

namespace neuvv::training {

// How a pixel compares with the background's.
struct Shade {
    float light = 1;             // the factor that comes nearest to making the background's colour this one, as encoded
    std::array<float, 3> hue{};  // what that factor leaves, by channel, in units of the camera's noise
};

// The pixels beyond those that show the background (`background`) into which it reaches as a shadow: darker, of its
// hue, and from pixel to pixel by small steps. Grey cloth before a grey wall is no shadow, as it has an edge. A small
// part of the background may be a place of the performer that happens to look like it: no shadow begins there.
PixelMask soft_shadows(const PixelMask& background, const std::vector<Shade>& shades);

}  // namespace neuvv::training
