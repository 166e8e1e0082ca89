// The pixels of a rig.
#pragma once

#include "training/rig.h"

namespace neuvv {

// Reads every picture, mask and plate that the rig names, on all cores. Throws InputError for pictures that cannot be
// read or whose sizes disagree, and where mattes are needed and no picture has one.
Dataset read_pictures(const Rig& rig, const LoadOptions& options);

}  // namespace neuvv
