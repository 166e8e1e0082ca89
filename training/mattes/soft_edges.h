// The alpha of pixels at the edge of a mask, which show both the performer and what is behind.
#pragma once

#include <vector>

#include "media/image.h"
#include "training/tree/pixel_mask.h"

namespace neuvv::training {

// One byte per pixel, row by row: 0 outside the mask, 255 inside. At its edge, alpha says where the pixel's colour
// lies, in linear light, between the background's colour there and the performer's colour beside it. Sizes must be
// equal (assert).
std::vector<uint8_t> soft_edges(const media::Image& image, const PixelMask& mask, const media::Image& background);

// The same where the background is not known: its colour is that beside the edge, too, and the true edge is sought
// within `band` pixels of the mask's. Where both sides have one colour, the mask decides.
std::vector<uint8_t> soft_edges(const media::Image& image, const PixelMask& mask, uint32_t band);

}  // namespace neuvv::training
