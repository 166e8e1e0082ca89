// An image projected onto a performer from a camera: where it is seen, leaves take its colours. Edits come without
// frames: at_frames says when they hold.
//
// The image's pixels are picked first: that says how far each sees. As many rays a pixel are cast as make them lie no
// farther apart than leaves are wide (of the narrowest leaves, at the nearest surface; at most
// kMaxProjectionRays a side, 64 million in all). Then each leaf that is there looks up the rays that pass through it:
// those that come as far take part, and the mean of the image at them is the leaf's colour, their mean alpha that of
// the edit. So no leaf between two rays is left out, and leaves in front of the picked one, through which the image
// is seen, are painted as well.
#pragma once

#include "edit/select.h"
#include "media/image.h"
#include "render/pick.h"

namespace neuvv::edit {

constexpr uint32_t kMaxProjectionRays = 8;

// The camera in the performer's space (in_performer: any affine transform will do), of the image's size; the picker
// shows the time that is painted on, `sigma` is densities() at it. Transparent pixels paint nothing.
std::vector<voctree::LeafEdit> project(render::Picker& picker, const Canvas& canvas, std::span<const float> sigma,
                                       const media::Image& image, const stage::Camera& camera);

}  // namespace neuvv::edit
