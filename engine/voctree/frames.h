// Frames of a clip: a part of them as a clip of its own, and leaves that none of them shows.
#pragma once

#include "voctree/voctree.h"

namespace neuvv::voctree {

// Removes the leaves whose density is 0 in every frame, and so at every time between frames. Images stay the same.
void drop_empty_leaves(VOctree& tree);

// The frames first … first + count − 1, of which there must be at least one and which the tree must have (assert).
// Their images are those of the whole clip. Bases and leaves that no frame of the part uses are left out.
VOctree frames_of(const VOctree& tree, uint32_t first, uint32_t count);

}  // namespace neuvv::voctree
