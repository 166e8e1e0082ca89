// Difference matting: the performer is what differs from the known background of a camera.
#pragma once

#include <vector>

#include "media/image.h"
#include "training/tree/pixel_mask.h"

namespace neuvv::training {

// Differences are measured in units of the camera's noise, which is estimated from the image itself by the median
// absolute deviation, so that the performer may cover up to half of the image. A constant difference of exposure is
// removed first.
struct MatteSettings {
    double threshold = 12;       // pixels that differ by more belong to the performer
    double low_share = 1.0 / 3;  // so do pixels connected to those that differ by more than this share of the threshold
    double hole_share = 0.002;   // holes of up to this share of the image are closed
    double speck_share = 0.0005;  // islands of up to this share of the image are removed
};

// Where a background comes from. Soft shadows (shadows.h) do not differ from a clean plate, and beside edges more noise
// is expected. In the median of images the performer may have left traces, beside which grey cloth looks like a soft
// shadow: there, all that exceeds the noise differs.
enum class BackgroundKind { kPlate, kMedian };
inline BackgroundKind kind_of_background(bool is_clean) {
    return is_clean ? BackgroundKind::kPlate : BackgroundKind::kMedian;
}

// The pixels that differ. Sizes must be equal (assert); the images' own alpha is ignored.
PixelMask differing_pixels(const media::Image& image, const media::Image& background, BackgroundKind kind,
                           const MatteSettings& settings);

// The same with soft edges, which the background's colours say (soft_edges.h): one byte per pixel, row by row, 0 is
// background, 255 performer.
std::vector<uint8_t> difference_matte(const media::Image& image, const media::Image& background, BackgroundKind kind,
                                      const MatteSettings& settings);

}  // namespace neuvv::training
