// Smaller images of the same cameras: the mean of side×side pixels is a pixel.
#pragma once

#include <cstdint>
#include <vector>

#include "media/image.h"
#include "stage/camera.h"

namespace neuvv::training {

// The mean of encoded values, as OpenCV's INTER_AREA takes it, by which published benchmarks are made smaller. RGB is
// weighted by alpha where any pixel has alpha above 0. Columns and rows that fill no pixel are dropped; the image must
// have `side` of each (assert).
media::Image reduced(const media::Image& image, uint32_t side);

// The same of the pixels to ignore, row by row: a pixel is ignored where any of its pixels is.
std::vector<bool> reduced(const std::vector<bool>& ignored, media::ImageSize size, uint32_t side);

stage::Camera reduced(const stage::Camera& camera, uint32_t side);

}  // namespace neuvv::training
