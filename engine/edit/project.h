// Projects an image onto a performer from a camera: leaves that the camera sees take the image's colours. The returned
// edits have no frames: at_frames gives them the frames at which they apply.
//
// First every pixel is picked, which says at which distance each ray ends. Rays are cast at least as densely as leaves
// are wide, judged by the narrowest leaf at the nearest surface, with at most kMaxProjectionRays per pixel side and 64
// million rays in all. Then each leaf with σ > 0 looks up the rays that pass through it. The rays that reach as far as
// the leaf count: its colour is the mean of the image at these rays, and the alpha of its edit is their mean alpha. So
// no leaf between two rays is left out, and leaves in front of the picked one, through which the image is seen, are
// painted as well.
#pragma once

#include "edit/select.h"
#include "media/image.h"
#include "render/volume/pick.h"

namespace neuvv::edit {

constexpr uint32_t kMaxProjectionRays = 8;

// `camera` is in the performer's space (in_performer: any affine transform is possible) and has the image's size. The
// picker shows the frame that is painted on, and `sigma` is densities() at that frame. Transparent pixels paint
// nothing.
std::vector<voctree::LeafEdit> project(render::Picker& picker, const Canvas& canvas, std::span<const float> sigma,
                                       const media::Image& image, const stage::Camera& camera);

}  // namespace neuvv::edit
