// Cameras that Pose2Sim or anipose calibrated (Calib.toml), beside videos or images by camera.
#pragma once

#include "training/layouts/rig.h"

namespace neuvv::training {

bool has_pose2sim_files(const std::filesystem::path& folder);

// Every 8th camera with images is held out for the test, beginning with the first in natural order of their names.
// Where no camera's name is that of a video, the videos belong to the cameras in natural order, as in Pose2Sim. Throws
// InputError with file, key and fix.
Rig read_pose2sim_rig(const std::filesystem::path& folder, Split split);

}  // namespace neuvv::training
