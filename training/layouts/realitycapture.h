// Cameras that RealityCapture (RealityScan) exported as a table, "Internal/External camera parameters", beside images
// or videos by camera.
#pragma once

#include "training/layouts/rig.h"

namespace neuvv::training {

bool has_realitycapture_files(const std::filesystem::path& folder);

// Every 8th camera with images is held out for the test, beginning with the first. Throws InputError with file, line
// and fix.
Rig read_realitycapture_rig(const std::filesystem::path& folder, Split split);

}  // namespace neuvv::training
