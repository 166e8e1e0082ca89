// Cameras that Qualisys Track Manager exported (Calib.qca.txt, XML), beside the videos of its video cameras.
#pragma once

#include "training/layouts/rig.h"

namespace neuvv::training {

bool has_qualisys_files(const std::filesystem::path& folder);

// Cameras are named by their serial numbers; those without images, as marker cameras are, are left out. Of the others
// every 8th is held out for the test, beginning with the first. Throws InputError with file, element and fix.
Rig read_qualisys_rig(const std::filesystem::path& folder, Split split);

}  // namespace neuvv::training
