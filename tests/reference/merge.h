// Merge: samples of several instances along one ray as those of one medium. It is computed by brute force: the borders
// of all samples with density divide the ray into parts, and each part sums all samples that contain it.
#pragma once

#include <vector>

#include "reference/composite.h"

namespace neuvv::reference {

// Where samples overlap, densities add up and colours are weighted by density (errata 11). The result is near to far.
std::vector<Sample> merge(const std::vector<std::vector<Sample>>& instances);

// The samples of an instance, near to far, in world space, where `world_metres` is the length of one metre of the
// instance's space (errata 13). Densities are multiplied by `density`. An instance of opacity o lets 1 − o (1 − T) of
// the light through where one of opacity 1 lets T through.
std::vector<Sample> in_world(const std::vector<Sample>& samples, double world_metres, double opacity,
                             double density = 1);

}  // namespace neuvv::reference
