// Data sets of the NeRF family: images beside a transforms.json, whose fields training/layouts/README.md lists.
#pragma once

#include <filesystem>

#include "training/layouts/rig.h"

namespace neuvv::training {

bool has_nerf_files(const std::filesystem::path& folder);

// Reads `folder`/transforms_train.json, _test.json or _val.json, or else the split's frames of a single
// transforms.json: those that its {train,test,val}_filenames list, else every 8th camera (the first, the 9th, …) is
// held out for the test split. Throws InputError with file, place in the JSON and fix.
Rig read_nerf_rig(const std::filesystem::path& folder, Split split);

}  // namespace neuvv::training
