// Difference matting: which part of an image is not the background that its camera is known to see.
#pragma once

#include <vector>

#include "media/image.h"

namespace neuvv::training {

// Per pixel and channel the median over the frames of a camera that stands still: the background wherever nothing
// covers it for half of them. Frames of one size (assert), at least one.
media::Image median_background(const std::vector<media::Image>& frames);

// Differences are measured in units of the camera's noise, which is estimated from the image itself (median absolute
// deviation: the performer may cover up to half of it); a constant difference of exposure is taken out.
struct MatteSettings {
    double threshold = 12;        // what differs by more belongs to the performer,
    double low_share = 1.0 / 3;   // and what touches that and differs by more than this share of the threshold
    double hole_share = 0.002;    // holes up to this share of the image are closed,
    double speck_share = 0.0005;  // and islands up to this one are dropped
};

// Alpha, a byte a pixel, row by row: 0 background, 255 performer, between them at the edge of the performer, where a
// pixel shows both: its place, in linear light, between the background's colour and that of the performer beside it.
// Sizes must be equal (assert); the images' own alpha is ignored.
std::vector<uint8_t> difference_matte(const media::Image& image, const media::Image& background,
                                      const MatteSettings& settings);

}  // namespace neuvv::training
