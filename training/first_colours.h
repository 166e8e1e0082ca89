// A first guess of colours: what the cameras see where a place projects to, occlusion ignored.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "training/dataset.h"

namespace neuvv::training {

// For each place (world, metres) the mean linear RGB of the foreground over cameras and a few of the dataset's times,
// those that `allowed` has a bit for (⌈times/32⌉ words a place, as carve() gives). Mid-grey where nothing is seen.
std::vector<glm::vec3> first_colours(const Dataset& dataset, const std::vector<glm::vec3>& positions,
                                     const std::vector<uint32_t>& allowed);

}  // namespace neuvv::training
