// Image quality against the truth, as the volumetric-video literature measures it.
//
// Both images are 8-bit sRGB, composited over white, compared whole, in encoded values scaled to [0,1].
#pragma once

#include "media/image.h"

namespace neuvv::training {

struct Quality {
    double psnr = 0;  // dB: −10·log10(mean over pixels and channels of squared error); capped at 99 for equal images
    double ssim = 0;  // Wang et al. 2004: 11×11 Gaussian window, σ 1.5, K1 0.01, K2 0.03, mean over RGB and pixels
                      // whose whole window lies inside the image (scikit-image's gaussian_weights=True,
                      // use_sample_covariance=False)
    double mae = 0;   // mean absolute error
    double flip = 0;  // mean LDR-FLIP (flip.h)
};

// Alpha is ignored (composite first). Sizes must be equal (assert) and at least 11×11 for SSIM (smaller: the window is
// cut to the image and renormalised).
Quality compare(const media::Image& truth, const media::Image& result);

// |truth − result| scaled so that 0.25 is white, for looking at.
media::Image error_image(const media::Image& truth, const media::Image& result);

}  // namespace neuvv::training
