// Rays of a pinhole camera.
#pragma once

#include "reference/trace.h"
#include "training/data/dataset.h"

namespace neuvv::reference {

// The ray through the centre of pixel (px, py), counted from the image's top left corner; px and py may lie outside of
// the image.
Ray camera_ray(const stage::Camera& camera, double px, double py);

}  // namespace neuvv::reference
