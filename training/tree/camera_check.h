// Checks the cameras of a capture against each other before it is trained.
#pragma once

#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

// Reads the images of a few times and looks for misfits (misfits.h). Where two cameras have each other's images, these,
// masks and plates are exchanged; other misfits are left out. Rig::remarks say what was done. A rig without mattes, or
// with fewer than kMinJudgedCameras, is left as it is. Throws InputError as read_images() does.
void check_cameras(Rig& rig);

// From so many cameras on, views between them gain little by more (training/RESULTS.md).
constexpr size_t kEnoughCameras = 10;
// Adds to Rig::remarks what to expect of a rig with fewer, which leave matter beside the performer that no image
// denies.
void note_few_cameras(Rig& rig);

}  // namespace neuvv::training
