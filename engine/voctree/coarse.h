// The same scene of fewer, larger leaves: what a player shows until the whole tree is there.
#pragma once

#include <optional>

#include "voctree/voctree.h"

namespace neuvv::voctree {

// Trees of fewer leaves open at once anyway.
constexpr uint32_t kCoarseFrom = 100'000;

// The tree cut at an octree depth (1 or more): every leaf below becomes part of the cell there that holds it. A cell's
// w^σ are means over its space, so rays gather the same optical depth on their way through it; its w^γ and w^HH are
// means of what its leaves show. Leaves above the cut stay. The tree must be sound.
VOctree cut_tree(const VOctree& tree, uint32_t depth);

// Cut as deep as at most a 32nd of the leaves allow, its weights rounded so that they pack well. Nothing for trees of
// fewer than kCoarseFrom leaves.
std::optional<VOctree> coarse_tree(const VOctree& tree);

}  // namespace neuvv::voctree
