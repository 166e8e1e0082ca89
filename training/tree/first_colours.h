// A first guess of the colour at positions in space: what cameras see where a position projects to, without occlusion.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "training/data/dataset.h"

namespace neuvv::training {

// For each position (world, metres) the mean linear RGB of the foreground over all cameras and a few times of the data
// set. A time counts where the position's bit in `allowed` is set (⌈times/32⌉ words per position, as carve() returns).
// Mid-grey where no camera sees foreground.
std::vector<glm::vec3> first_colours(const Dataset& dataset, const std::vector<glm::vec3>& positions,
                                     const std::vector<uint32_t>& allowed);

}  // namespace neuvv::training
