// How the tree of a training run begins and changes: from the visual hull, coarse to fine.
#pragma once

#include "training/data/dataset.h"
#include "training/tree/leaf_use.h"
#include "voctree/voctree.h"

namespace neuvv::training {

struct TreeShape {
    uint32_t resolution = 0;  // finest leaves along the longest side of the hull's box; 0: natural_resolution
    uint32_t bases = 31;      // C; no more than one per frame are used
    uint32_t hh_degree = 1;
    // Metres by which the hull is wider than the mattes say, for cameras whose poses are not trusted.
    double hull_margin = 0;
};

constexpr uint32_t kMaxResolution = 2048;

// Octree depth of the finest leaves of a tree of this resolution.
uint32_t depth_of_resolution(uint32_t resolution);

// The number of leaves along the box's longest side with which a leaf is as large as a pixel at the box's distance,
// between 32 and 512.
uint32_t natural_resolution(const Dataset& dataset, const std::pair<glm::dvec3, glm::dvec3>& box);

// The first tree. Its leaves are cubes, all `levels_above` levels above the finest depth, wherever the hull allows
// matter in any frame. They have the colours of first_colours, are partly opaque in frames in which the hull allows
// matter, and empty in the others. Throws InputError as hull_box does, and where no leaf is left.
voctree::VOctree initial_tree(const Dataset& dataset, TreeShape shape, uint32_t levels_above);

// Rays of tiles farther away from the foreground than the hull reaches meet no leaf, so they have no gradient.
constexpr uint32_t kLeastReach = 2;

// How many tiles of 8×8 pixels beyond the outlines of mattes the leaves of the first tree reach at most, at least
// kLeastReach. `box_min`, `box_size` are the tree's, `depth` is that of these leaves, `margin` is
// TreeShape::hull_margin.
uint32_t reach_of_hull(const Dataset& dataset, const glm::vec3& box_min, const glm::vec3& box_size, uint32_t depth,
                       double margin);

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
