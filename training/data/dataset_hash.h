// Tells data sets apart.
#pragma once

#include "training/data/dataset.h"

namespace neuvv::training {

// XXH3-64 of cameras, sizes, times, which tiles hold foreground, and every 101st byte of these tiles and of plates:
// enough to tell data sets apart. What lies under alpha 0 does not count.
uint64_t hash_of(const Dataset& dataset);

}  // namespace neuvv::training
