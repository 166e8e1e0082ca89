// Image quality against the truth, as the literature on volumetric video measures it.
//
// Both images are 8-bit sRGB, composited over one colour. They are compared as a whole, in encoded values scaled to
// [0,1].
#pragma once

#include "media/image.h"

namespace neuvv::training {

struct Quality {
    double psnr = 0;  // dB (media::psnr_db)
    // Wang et al. 2004: 11×11 Gaussian window, σ 1.5, K1 0.01, K2 0.03; the mean over RGB and over pixels whose whole
    // window lies inside the image (scikit-image's gaussian_weights=True, use_sample_covariance=False).
    double ssim = 0;
    double mae = 0;   // mean absolute error
    double flip = 0;  // mean LDR-FLIP (flip.h)
};

// Alpha is ignored: composite first. The images must have one size (assert). In images smaller than 11×11 pixels, the
// window of SSIM is cut to the image and normalised again.
Quality compare(const media::Image& truth, const media::Image& result);

// |truth − result| per channel, scaled so that 0.25 is white, for people to look at. Needs images of one size (assert).
media::Image error_image(const media::Image& truth, const media::Image& result);

}  // namespace neuvv::training
