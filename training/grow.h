// How the tree of a training run comes to be and changes: from the visual hull, coarse to fine.
#pragma once

#include "training/dataset.h"
#include "training/slice_adjoint.h"
#include "voctree/voctree.h"

namespace neuvv::training {

struct TreeShape {
    uint32_t resolution = 0;  // finest leaves along the longest side of the hull's box; 0: as fine as the images show
    uint32_t bases = 31;      // C, at most one for each frame is used
    uint32_t hh_degree = 1;
};

constexpr uint32_t kMaxResolution = 2048;

// Octree depth of the finest leaves of a tree of this resolution.
uint32_t depth_of_resolution(uint32_t resolution);

// Leaves along the longest side such that a leaf is as large as a pixel at the scene's distance.
uint32_t natural_resolution(const Dataset& dataset, const std::pair<glm::dvec3, glm::dvec3>& box);

// A tree whose leaves, all `levels_above` the finest depth, are where the hull allows matter in any frame, in
// first_colours, faintly opaque in the frames that the hull allows, empty in the others. Cells are cubes. Throws
// InputError as hull_box does.
voctree::VOctree initial_tree(const Dataset& dataset, TreeShape shape, uint32_t levels_above);

struct GrowSettings {
    uint32_t max_depth = 0;
    float prune_below = 0;      // leaves whose reach stays under it go (0: none)
    bool empty_unused = false;  // leaves that stay are emptied in frames that did not use them, where C = frames
    float min_weight_to_divide =
        2;                   // leaves of at least this reach may become their children, those that the hull allows;
    float divide_share = 1;  // of those that may, the share at which the loss pulls hardest,
    double min_pixels_to_divide = 0;  // and whose edge is at least so many pixels in the camera that is nearest to them
    uint32_t max_leaves = 0;  // where more would be kept, those of least reach go; where dividing would pass it, only
                              // those of most reach, or of most pull, are divided (0: no bound)
};

// Children inherit their parent's weights, but are empty in the frames that the hull forbids them.
voctree::VOctree grow(const Dataset& dataset, const voctree::VOctree& tree, const LeafUse& use,
                      const GrowSettings& settings);

}  // namespace neuvv::training
