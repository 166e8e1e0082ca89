// A coarse copy of a tree, of fewer and larger leaves, which is displayed until the whole tree has been read.
#pragma once

#include <optional>

#include "voctree/voctree.h"

namespace neuvv::voctree {

// Smaller trees need no coarse copy, because they open quickly.
constexpr uint32_t kMinLeavesForCoarse = 100'000;

// The tree cut at an octree depth (1 or more): the leaves below are merged into the cells at that depth that contain
// them. A cell's w^σ are means over its volume, so that a ray on average gathers the same optical depth in it. Its w^γ
// and w^HH are means weighted by how much its leaves contribute to an image. Leaves above the cut stay. The tree must
// have no defect_of.
VOctree cut_tree(const VOctree& tree, uint32_t depth);

// The tree cut at the largest depth that leaves at most a 32nd of the leaves, with weights rounded so that they pack
// well. Nothing for trees of fewer than kMinLeavesForCoarse leaves.
std::optional<VOctree> coarse_tree(const VOctree& tree);

}  // namespace neuvv::voctree
