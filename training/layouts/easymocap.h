// Data sets of EasyMocap, and of ZJU-MoCap in its layout: intri.yml, extri.yml and a folder of images per camera.
#pragma once

#include <filesystem>

#include "training/layouts/rig.h"

namespace neuvv::training {

bool has_easymocap_files(const std::filesystem::path& folder);

// Cameras without images are left out. Of the others every 8th (the first, the 9th, … in the order of `names`) is held
// out for the test split. Throws InputError with file, place and fix.
Rig read_easymocap_rig(const std::filesystem::path& folder, Split split);

}  // namespace neuvv::training
