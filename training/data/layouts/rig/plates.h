// Clean plates: what a camera sees of the place without the performer.
#pragma once

#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

// Gives the cameras that have no plate yet theirs: plates/<camera>.png (or .jpg), or a video plates/<camera>.mp4 (or
// another ending), of whose frames the median is the plate. Adds a remark where plates/ exists and lacks some.
void find_plates(Rig& rig);

}  // namespace neuvv::training
