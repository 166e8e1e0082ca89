// Finds the shape of splats whose images are most like those of the clip.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "interchange/splats/splat_image.h"

namespace neuvv::interchange {

// An image of the volume on white, as it should look.
struct FitView {
    stage::Camera camera;
    media::Image image;
};

// `count` leaves at equal steps of what images show of all leaves, in their order. There must be a leaf.
std::vector<slice::Leaf> typical_leaves(const slice::Slice& volume, size_t count);

// The camera's image around a leaf before it, enlarged until the leaf's edge is four pixels long where it is shorter.
// There, the 0.3 pixels² by which renderers widen splats close no gaps between splats.
stage::Camera close_up(const stage::Camera& camera, const slice::Slice& volume, const slice::Leaf& leaf);

// PSNR in dB of the images of splats, all pixels of all views together.
double psnr_of(const Splats& splats, std::span<const FitView> views);

struct SplatFit {
    SplatShape shape;
    double psnr = 0;
};
// Changes width and density of all leaves by ever smaller factors, as long as the PSNR grows: each alone, and both so
// that splats keep their opacity over their area. Draws up to sixty times as many images as there are views, and calls
// `between` before each time, which may throw.
SplatFit fit_shape(const slice::Slice& volume, std::span<const FitView> views, const std::function<void()>& between);

}  // namespace neuvv::interchange
