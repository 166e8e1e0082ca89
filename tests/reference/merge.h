// Merge: samples of several instances along one ray as those of one medium, by brute force: every border of any sample
// with density parts the ray, and each part asks every sample.
#pragma once

#include <vector>

#include "reference/composite.h"

namespace neuvv::reference {

// Where samples overlap, densities add and colours weigh by density (errata 11). Near to far.
std::vector<Sample> merge(const std::vector<std::vector<Sample>>& instances);

// The samples of an instance, near to far, as the world has them that measures `world_metres` for each of the
// instance's (errata 13); an instance of opacity o lets 1 − o (1 − T) through where a solid one lets T.
std::vector<Sample> in_world(const std::vector<Sample>& samples, double world_metres, double opacity);

}  // namespace neuvv::reference
