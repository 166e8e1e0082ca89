// Difference matting: the performer is what differs from the known background of a camera.
#pragma once

#include <vector>

#include "media/image.h"

namespace neuvv::training {

// How many images of a camera its background is the median of at most.
constexpr uint32_t kMaxMedianFrames = 31;

// The median over frames of a camera that stands still, per pixel and channel. It shows the background wherever the
// background is visible in more than half of the frames. Needs at least one frame, and frames of one size (assert).
media::Image median_background(const std::vector<media::Image>& frames);

// Differences are measured in units of the camera's noise, which is estimated from the image itself by the median
// absolute deviation, so that the performer may cover up to half of the image. A constant difference of exposure is
// removed first.
struct MatteSettings {
    double threshold = 12;       // pixels that differ by more belong to the performer
    double low_share = 1.0 / 3;  // so do pixels connected to those that differ by more than this share of the threshold
    double hole_share = 0.002;   // holes of up to this share of the image are closed
    double speck_share = 0.0005;  // islands of up to this share of the image are removed
};

// Alpha, one byte per pixel, row by row: 0 is background, 255 performer. A pixel at the edge of the performer shows
// both: its alpha says where its colour lies, in linear light, between the background's colour and that of the
// performer beside it. Sizes must be equal (assert); the images' own alpha is ignored.
std::vector<uint8_t> difference_matte(const media::Image& image, const media::Image& background,
                                      const MatteSettings& settings);

}  // namespace neuvv::training
