// Recordings of the app Record3D: metadata, and a folder of images.
#pragma once

#include "training/layouts/rig.h"

namespace neuvv::training {

bool has_record3d_files(const std::filesystem::path& folder);

// Every image is a camera of its own, and all of them show one frame. Every 8th is held out for the test, beginning
// with the first. Throws InputError with file, place in the JSON and fix.
Rig read_record3d_rig(const std::filesystem::path& folder, Split split);

}  // namespace neuvv::training
