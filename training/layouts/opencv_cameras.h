// Calibrations that programs wrote with OpenCV's cv::FileStorage, a YAML file for each camera, beside images or videos
// by camera.
#pragma once

#include "training/layouts/rig.h"

namespace neuvv::training {

bool has_opencv_files(const std::filesystem::path& folder);

// Every file of the folder or of its folder calibration/ that has a camera matrix is a camera, with the file's name.
// Every 8th with images is held out for the test, beginning with the first in natural order. Throws InputError with
// file, key and fix.
Rig read_opencv_rig(const std::filesystem::path& folder, Split split);

}  // namespace neuvv::training
