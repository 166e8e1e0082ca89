// The part of a tree's box that its leaves fill.
#pragma once

#include <utility>

#include "voctree/files/clip_index.h"
#include "voctree/voctree.h"

namespace neuvv::voctree {

// Minimum and maximum corner of the box around the tree's leaves, in metres; of the tree's own box where it has no
// leaf.
std::pair<glm::dvec3, glm::dvec3> occupied_box(const VOctree& tree);
// The same of leaves in a box, metres.
std::pair<glm::dvec3, glm::dvec3> occupied_box(const std::vector<LeafPosition>& leaves, glm::vec3 box_min,
                                               glm::vec3 box_size);

// The same of a whole clip: around the leaves of at most eight of its segments, at equal steps, that can be read. Where
// a file has a coarse tree, that alone is read, whose leaves are larger. Streams say it without that; of older ones,
// key frames are read, and the box is a tenth larger on each side for what moves between them. Throws InputError where
// none of them can be read.
std::pair<glm::dvec3, glm::dvec3> occupied_box(const ClipIndex& clip);

}  // namespace neuvv::voctree
