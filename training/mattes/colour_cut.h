// Divides an image into figure and background where their colours say so.
#pragma once

#include "media/image.h"
#include "training/tree/pixel_mask.h"

namespace neuvv::training {

// Where the figure may be, and must be.
struct FigureBounds {
    PixelMask sure, probable;  // the figure for certain; by what is known so far
    PixelMask possible;        // all else is background
};

// The figure of `image` by GrabCut (Rother et al. 2004): colours of figure and background are learnt from what is
// probable, and the border runs where neighbouring pixels differ. Returns `probable` within the bounds where there are
// too few pixels to learn from. Sizes must be equal (assert).
PixelMask cut_by_colour(const media::Image& image, const FigureBounds& bounds);

}  // namespace neuvv::training
