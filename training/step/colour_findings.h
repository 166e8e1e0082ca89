// What the learnt colours of cameras say of a rig, and which of them are worth learning on.
#pragma once

#include "training/step/camera_colour.h"

namespace neuvv::training {

// The smallest findings that are worth correcting. Clean runs of 2 to 56 epochs find gains within 5 % and
// exposures within 2 %.
constexpr double kWorthGain = 0.08;       // of any camera's gain from 1
constexpr double kWorthExposure = 0.03;   // root of the mean square of the logarithms of exposures
constexpr double kWorthVignetting = 0.2;  // light that any camera misses at its corners, or has too much of

// What one camera's findings come to, in words of the constants above.
double largest_gain_error(const CameraColours& colours, size_t camera);
double exposure_error(const CameraColours& colours, size_t camera);
double missing_at_corners(const CameraColours& colours, size_t camera);

// What of it exceeds the constants above in some camera, exposures in all cameras together.
ColourRefinement worthwhile(const CameraColours& colours);

}  // namespace neuvv::training
