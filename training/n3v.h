// Neural 3D Video and other captures of the LLFF kind: poses_bounds.npy beside one video a camera.
#pragma once

#include "training/rig.h"

namespace neuvv::training {

bool has_n3v_files(const std::filesystem::path& folder);

// The camera of the first row is the test view, the others train. Frame i of n is the time i/(n−1). Throws InputError.
Rig read_n3v_rig(const std::filesystem::path& folder, Split split);

}  // namespace neuvv::training
