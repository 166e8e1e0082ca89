// Clean plates: what a camera sees without the performer.
#pragma once

#include <vector>

#include "media/image.h"
#include "training/data/layouts/rig/image_reader.h"

namespace neuvv::training {

// How many images of a camera its background is the median of at most.
constexpr uint32_t kMaxMedianFrames = 31;

// The median over frames of a camera that stands still, per pixel and channel. It shows the background wherever the
// background is visible in more than half of the frames. Needs at least one frame, and frames of one size (assert).
media::Image median_background(const std::vector<media::Image>& frames);

// The clean plate that the source names: an image, or of a video, per pixel, the median of up to kMaxMedianFrames
// frames, over which people who walk through its first frames count little.
media::Image read_plate(const ImageSource& source, const ImageReader::ExpectSize& expect_size = {});

}  // namespace neuvv::training
