// The tree with which a training run begins: coarse leaves wherever the visual hull allows matter.
#pragma once

#include "training/data/dataset.h"
#include "training/tree/carved_leaves.h"
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

// Gives the leaves of a tree, which are `carved`, their weights: the colours of first_colours, and this optical depth
// over their edges in frames in which the hull allows matter.
void set_first_weights(const Dataset& dataset, voctree::VOctree& tree, const Carved& carved, float optical_depth);

// Rays of tiles farther away from the foreground than the hull reaches meet no leaf, so they have no gradient.
constexpr uint32_t kLeastReach = 2;

// How many tiles of 8×8 pixels beyond the outlines of mattes the leaves of the first tree reach at most, at least
// kLeastReach. `box_min`, `box_size` are the tree's, `depth` is that of these leaves, `margin` is
// TreeShape::hull_margin.
uint32_t reach_of_hull(const Dataset& dataset, const glm::vec3& box_min, const glm::vec3& box_size, uint32_t depth,
                       double margin);

}  // namespace neuvv::training
