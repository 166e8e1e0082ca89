// Images of a distorting lens, resampled to what a pinhole of the same focal length and size would have shown.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "media/image.h"
#include "training/lens.h"

namespace neuvv::training {

// For each pixel of the pinhole image, the place in the distorted one that its centre shows, in pixels; x < 0 where
// the lens never saw it: beyond the image's edge, or where the distortion folds over.
struct Undistortion {
    uint32_t width = 0, height = 0;
    std::vector<glm::vec2> positions;
    double seen_share = 1;    // share of the pixels
    double fold_degrees = 0;  // off the axis, where within the image the distortion folds over; 0: nowhere

    bool sees(size_t pixel) const { return positions[pixel].x >= 0; }
};

// The lens must know its image's size.
Undistortion make_undistortion(const Lens& lens);

// Bilinear in linear light; colour is weighted by alpha unless it is that of the whole captured light (a plate, or a
// image before one). What the lens never saw becomes 0 0 0 0.
enum class ColourOf { kForeground, kCapture };
media::Image undistort(const media::Image& image, const Undistortion& map, ColourOf colour);

// The pixels that must be ignored: unseen ones, and those that show any of `ignored` (row-major; empty: none). Empty
// where there is none.
std::vector<bool> undistort_ignored(const std::vector<bool>& ignored, const Undistortion& map);

}  // namespace neuvv::training
