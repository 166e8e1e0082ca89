// Small random trees for the reference's tests, built here from their leaves' places so that a mistake in the engine's
// own builder cannot hide.
#pragma once

#include <vector>

#include "reference_test/numeric.h"
#include "voctree/voctree.h"

namespace neuvv::reference::test {

struct SmallTree {
    VOctree tree;
    std::vector<LeafPlace> places;  // by leaf index
};

// Random subdivision down to 2·node_levels octree levels; leaves at mixed depths, shuffled; bits of the space stay
// empty.
SmallTree random_small_tree(Random& random, uint32_t node_levels, uint32_t degree = 2);

// By search over all places: the leaf at a tree-space position, or UINT32_MAX.
uint32_t leaf_at(const std::vector<LeafPlace>& places, glm::dvec3 position_tree);

}  // namespace neuvv::reference::test
