// The difference of two images in decibels.
#pragma once

#include "media/image.h"

namespace neuvv::media {

constexpr double kMaxPsnr_db = 99;  // of equal images

// −10·log10 of the mean over pixels and channels of the squared error, of 8-bit values scaled to [0,1]; at most
// kMaxPsnr_db. Alpha is ignored: composite first. The images must have one size (assert).
double psnr_db(const Image& truth, const Image& result);

}  // namespace neuvv::media
