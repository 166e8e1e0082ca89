// An octree without its finest depths, for who shows fewer leaves than a stream has: what is left out of a frame need
// not be decoded, because a stream has the values of larger cells, too.
#pragma once

#include <cstdint>
#include <vector>

#include "stream/codec/octree.h"

namespace neuvv::stream {

// By how many levels leaves may become larger: blocks of leaves that frames repeat stay whole.
constexpr uint32_t kMostCoarser = 2;

// By how many levels leaves have to become larger so that there are at most `budget`; the most that can be where even
// then there are more. 0: no limit.
uint32_t coarser_levels(const Octree& tree, uint32_t budget);

struct CoarserOctree {
    Octree tree;
    // By leaf: the area (area_of) of the leaves of the other tree in it, as if it were one of the finest ones of this
    // tree. So leaves that both trees have, have 4^levels.
    std::vector<int32_t> areas;
};
// `levels`: 1 to kMostCoarser, and less than the tree's depth. The tree must have leaves.
CoarserOctree coarser_octree(const Octree& tree, uint32_t levels);

// The opacity of a leaf of the coarser tree along its edge, in units of 1/kUnit, where the leaves in it have this mean
// opacity along theirs. They are taken to lie side by side, and once they fill the side, behind each other.
int16_t opacity_of_coarser(int16_t mean, int32_t area, uint32_t levels);

}  // namespace neuvv::stream
