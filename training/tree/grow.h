// How the tree of a training run changes: leaves that rays hardly use go, and others divide, within the visual hull.
#pragma once

#include "training/data/dataset.h"
#include "training/tree/leaf_use.h"
#include "voctree/voctree.h"

namespace neuvv::training {

struct GrowSettings {
    uint32_t max_depth = 0;
    float prune_below = 0;      // leaves whose maximum weight is below this are removed (0: none), unless hidden
    bool empty_unused = false;  // empty leaves in the frames that did not use them, where C = frames
    // A leaf may divide, into those of its children that the hull allows, if its maximum weight is at least
    // min_weight_to_divide and its edge covers at least min_pixels_to_divide pixels in the camera where it looks
    // largest.
    float min_weight_to_divide = 2;
    double min_pixels_to_divide = 0;
    // How many leaves may divide, as a share of all leaves. Below 1, those of highest opacity sensitivity do.
    float divide_share = 1;
    // The bound on the number of leaves (0: none). Where more would stay, those of lowest maximum weight are removed.
    // Where dividing would exceed it, those of highest opacity sensitivity (with divide_share 1: of highest maximum
    // weight) divide.
    uint32_t max_leaves = 0;
    double hull_margin = 0;  // TreeShape::hull_margin
    // Leaves of max_depth that stay are removed, or emptied in frames, as the hull says of leaves of the finest depth:
    // they were made as leaves that were to divide, of which the hull keeps more.
    bool carve_kept = false;
};

// The tree after pruning and division. Children inherit their parent's weights, but are empty in the frames in which
// the hull forbids them. Where no leaf would be left, the tree stays as it is.
voctree::VOctree grow(const Dataset& dataset, const voctree::VOctree& tree, const LeafUse& use,
                      const GrowSettings& settings);

}  // namespace neuvv::training
