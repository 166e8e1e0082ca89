// Cameras that have each other's images, found before their mattes are made together.
#pragma once

#include <string>
#include <vector>

#include "training/mattes/camera_shots.h"
#include "training/mattes/difference.h"

namespace neuvv::training {

// Looks at what differs from the backgrounds at a few times (find_misfits). Cameras that have each other's images get
// their own, with their backgrounds; `cameras` and `backgrounds` are in one order, and stay so. Returns a sentence for
// each pair. Where backgrounds are not good enough to tell, nothing changes. Throws InputError where an image cannot be
// read.
std::vector<std::string> swap_images_back(std::vector<CameraShots>& cameras, std::vector<CameraBackground>& backgrounds,
                                          const MatteSettings& settings);

}  // namespace neuvv::training
