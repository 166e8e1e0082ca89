// LDR-FLIP: how strongly a person who flips between two images sees them differ (Andersson et al., "FLIP: A
// Difference Evaluator for Alternating Images", 2020).
#pragma once

#include <vector>

#include "media/image.h"

namespace neuvv::training {

// Pixels per degree of vision: a 0.7 m wide screen of 3840 pixels, 0.7 m away.
constexpr double kPixelsPerDegree = 67.0206;

// One value in [0,1] per pixel, row by row; 0 where no difference is visible. The images must have one size (assert).
// Alpha is ignored: composite first.
std::vector<float> flip(const media::Image& a, const media::Image& b, double pixels_per_degree = kPixelsPerDegree);

double mean_of(const std::vector<float>& errors);

// Such values as an image for people to look at: from 0, black, over purple and orange to 1, pale yellow. Needs
// width · height values (assert).
media::Image flip_image(const std::vector<float>& errors, uint32_t width, uint32_t height);

}  // namespace neuvv::training
