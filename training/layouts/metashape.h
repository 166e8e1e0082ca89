// Cameras that Agisoft Metashape exported as XML (cameras.xml), beside images or videos by camera.
#pragma once

#include "training/layouts/rig.h"

namespace neuvv::training {

bool has_metashape_files(const std::filesystem::path& folder);

// Every 8th camera with images is held out for the test, beginning with the first. Throws InputError with file, element
// and fix.
Rig read_metashape_rig(const std::filesystem::path& folder, Split split);

}  // namespace neuvv::training
