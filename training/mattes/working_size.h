// Figures are sought in small images of a pinhole, and asked for in what the camera took.
#pragma once

#include <optional>

#include "media/image.h"
#include "stage/camera.h"
#include "training/data/layouts/rig/rig.h"
#include "training/data/undistort.h"
#include "training/tree/pixel_mask.h"

namespace neuvv::training {

// A camera whose images are reduced by a whole factor, to at most kWorkingSide pixels along the longer side, and freed
// of its lens's distortion.
struct WorkingCamera {
    stage::Camera camera;                      // a pinhole of the small images' size
    interchange::Lens lens;                    // of the images that the camera took, all of them of one size
    uint32_t factor = 1;                       // pixels of such an image along the side of a small one
    std::optional<Undistortion> undistortion;  // of small images; nothing where straight lines look straight
};

constexpr uint32_t kWorkingSide = 640;

// For images of this size.
WorkingCamera working_camera(const RigCamera& camera, media::ImageSize size);
// An image of the camera at the small size. Its alpha is ignored. The image must have the lens's size (assert).
media::Image working_image(const WorkingCamera& camera, const media::Image& image);
// The pixels of small images that the lens never saw.
PixelMask unseen_pixels(const WorkingCamera& camera);
// The same pixels in an image that the camera took.
PixelMask full_size(const WorkingCamera& camera, const PixelMask& mask);

}  // namespace neuvv::training
