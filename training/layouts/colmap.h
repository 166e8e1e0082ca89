// Data sets calibrated by COLMAP. Layout: training/layouts/README.md.
#pragma once

#include <filesystem>

#include "training/layouts/rig.h"

namespace neuvv::training {

bool has_colmap_files(const std::filesystem::path& folder);

// Reads the sparse model in `folder`/sparse/0, sparse, colmap/sparse/0 or the folder itself. Every 8th camera (the
// first, the 9th, … in natural order of their names) is held out for the test split. Throws InputError with file,
// place and fix.
Rig read_colmap_rig(const std::filesystem::path& folder, Split split);

}  // namespace neuvv::training
