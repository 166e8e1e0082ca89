// What a data set's files already say of which pixels show the performer.
#pragma once

#include <string>
#include <vector>

#include "training/data/layouts/rig/rig.h"

namespace neuvv::training {

// mattes/, masks that mean mattes, or an alpha of the images, of which one image of each of a few cameras is read. In
// the order in which they count: each overrules those behind it. Empty where there is none.
std::vector<std::string> matte_sources(const std::vector<Rig>& splits);

}  // namespace neuvv::training
