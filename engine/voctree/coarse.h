// Coarse copies of a tree, of fewer and larger leaves: for performers that are far away, and for what is displayed
// until the whole tree has been read.
#pragma once

#include <optional>

#include "voctree/voctree.h"

namespace neuvv::voctree {

// Smaller trees need no coarse copy, because they open quickly.
constexpr uint32_t kMinLeavesForCoarse = 100'000;

// The depth of the finest leaves; 1 where there are none.
uint32_t finest_depth(const VOctree& tree);

// The tree cut at an octree depth (1 or more): the leaves below are merged, depth by depth, into the cells that contain
// them. A cell passes as much light along its edges as its octants do, in the mean over its face: at least along the
// axis on which they cover least, and along the others more. (The mean density over the volume would make edges opaque
// that cover half a cell.) Its w^γ and w^HH are means weighted by how much its leaves contribute to an image. Leaves
// above the cut stay. The tree must have no defect_of.
VOctree cut_tree(const VOctree& tree, uint32_t depth);

// The tree cut at the largest depth that leaves at most a 32nd of the leaves, with weights rounded so that they pack
// well. Nothing for trees of fewer than kMinLeavesForCoarse leaves.
std::optional<VOctree> coarse_tree(const VOctree& tree);

}  // namespace neuvv::voctree
