// Neural 3D Video and other captures in the layout of LLFF: poses_bounds.npy beside one video per camera.
#pragma once

#include "training/layouts/rig.h"

namespace neuvv::training {

bool has_n3v_files(const std::filesystem::path& folder);

// The camera of the first row is the test split, the others are the training split. Frame i of n has the time i/(n−1),
// where n is the number of frames of the shortest video. Throws InputError.
Rig read_n3v_rig(const std::filesystem::path& folder, Split split);

}  // namespace neuvv::training
