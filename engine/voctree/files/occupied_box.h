// The part of a tree's box that its leaves fill.
#pragma once

#include <utility>

#include "voctree/voctree.h"

namespace neuvv::voctree {

// Minimum and maximum corner of the box around the tree's leaves, in metres; of the tree's own box where it has no
// leaf.
std::pair<glm::dvec3, glm::dvec3> occupied_box(const VOctree& tree);
// The same of leaves in a box, metres.
std::pair<glm::dvec3, glm::dvec3> occupied_box(const std::vector<LeafPosition>& leaves, glm::vec3 box_min,
                                               glm::vec3 box_size);

}  // namespace neuvv::voctree
