// Clean plates: what a camera sees without the performer.
#pragma once

#include "training/data/layouts/rig/image_reader.h"

namespace neuvv::training {

// The clean plate that the source names: an image, or of a video, per pixel, the median of up to kMaxMedianFrames
// frames (matte.h), over which people who walk through its first frames count little.
media::Image read_plate(const ImageSource& source, const ImageReader::ExpectSize& expect_size = {});

}  // namespace neuvv::training
