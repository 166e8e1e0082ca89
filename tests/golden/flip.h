// LDR-FLIP: how strongly a person who flips between two pictures sees them differ (Andersson et al., "FLIP: A
// Difference Evaluator for Alternating Images", 2020).
#pragma once

#include <vector>

#include "media/image.h"

namespace neuvv::test {

// Pixels per degree of vision: a 0.7 m wide screen of 3840 pixels, 0.7 m away.
constexpr double kPixelsPerDegree = 67.0206;

// One value in [0,1] a pixel, 0: no difference is seen. Pictures of one size; alpha is ignored: composite first.
std::vector<double> flip(const Image& a, const Image& b, double pixels_per_degree = kPixelsPerDegree);

}  // namespace neuvv::test
