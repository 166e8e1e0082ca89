// The box that the leaves of a whole clip fill.
#pragma once

#include <glm/glm.hpp>
#include <utility>

#include "voctree/files/clip_index.h"

namespace neuvv::voctree {

// Minimum and maximum corner, in metres, around the leaves of at most eight of its segments, at equal steps, that can
// be read. Where a file has a coarse tree, that alone is read, whose leaves are larger. Streams say it without that; of
// older ones, key frames are read, and the box is a tenth larger on each side for what moves between them. Throws
// InputError where none of them can be read.
std::pair<glm::dvec3, glm::dvec3> occupied_box(const ClipIndex& clip);

}  // namespace neuvv::voctree
