// Data sets of the NeRF family: images beside a transforms.json. Fields: training/README.md.
#pragma once

#include <filesystem>

#include "training/rig.h"

namespace neuvv::training {

bool has_nerf_files(const std::filesystem::path& folder);

// Reads `folder`/transforms_train.json or _test.json, or one transforms.json of which every 8th camera (the first, the
// 9th, …) is held out for the test split. Throws InputError naming file, JSON place and fix.
Rig read_nerf_rig(const std::filesystem::path& folder, Split split);

}  // namespace neuvv::training
