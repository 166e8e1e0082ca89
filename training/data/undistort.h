// Resamples images of a distorting lens to what a pinhole of the same focal length and size would have shown.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "interchange/camera/lens.h"
#include "media/image.h"

namespace neuvv::training {

// For each pixel of the pinhole image, where the distorted image shows what the pixel's centre shows.
struct Undistortion {
    uint32_t width = 0, height = 0;
    // In pixels of the distorted image, row by row; x < 0 where the lens never saw it: beyond the distorted image's
    // edge, or where the distortion folds over.
    std::vector<glm::vec2> positions;
    double seen_share = 1;    // share of the pixels
    double fold_degrees = 0;  // off the axis, where within the image the distortion folds over; 0: nowhere

    bool sees(size_t pixel) const { return positions[pixel].x >= 0; }
};

// The lens must know the size of its image (assert).
Undistortion make_undistortion(const interchange::Lens& lens);

// Resamples bilinearly in linear light. With kForeground, colours are weighted by alpha. With kCapture they are not, as
// RGB is then all the light that the camera saw (a plate, or an image whose camera has one). Pixels that the lens never
// saw become 0 0 0 0. The image must have the map's size (assert).
enum class ColourOf { kForeground, kCapture };
media::Image undistort(const media::Image& image, const Undistortion& map, ColourOf colour);

// The pixels of the pinhole image to be ignored, row by row: those that the lens never saw, and those that show any
// pixel of `ignored` (row by row; empty: none). Empty where there are none.
std::vector<bool> undistort_ignored(const std::vector<bool>& ignored, const Undistortion& map);

}  // namespace neuvv::training
