// Leaves that the visual hull allows, and what it says of their densities: what the first tree and its growth share.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "training/data/dataset.h"
#include "training/tree/hull.h"
#include "voctree/voctree.h"

namespace neuvv::training {

// The optical depth over its edge, below 0, that a leaf gets where it must be empty.
constexpr float kForbiddenOpacity = 0.1f;

// The ball by which a leaf is carved, `margin` metres wider. That of a coarse leaf encloses it, so that no child is
// lost. That of a leaf of the finest depth is smaller: a hull that misses matter in corners of leaves is better than
// one with a fringe of empty leaves, which training would have to clear.
HullCell hull_cell(const voctree::VOctree& tree, const voctree::LeafPosition& position, uint32_t finest,
                   double margin = 0);

// Adds the eight children of a leaf.
void append_children(std::vector<voctree::LeafPosition>& positions, const voctree::LeafPosition& position);

// Positions of leaves in which the hull allows matter in at least one frame.
struct Carved {
    std::vector<voctree::LeafPosition> positions;
    std::vector<uint32_t> bits;  // as carve() returns them, one bit per time of the data set
    std::vector<uint32_t> kept;  // per position: its index among those given to keep_allowed
};

// Those of `positions` that the hull allows, in their order. `finest`, `margin`: as in hull_cell().
Carved keep_allowed(const Dataset& dataset, const voctree::VOctree& tree,
                    const std::vector<voctree::LeafPosition>& positions, uint32_t finest, double margin);

// The density with which a leaf of this octree depth has an optical depth over its edge.
inline float density_of(const voctree::VOctree& tree, uint32_t depth, float optical_depth) {
    return optical_depth * static_cast<float>(1u << depth) / tree.box_size.x;
}

// Makes the σ of each frame of leaf `i`, `values`, negative in the frames in which the hull forbids it.
void fit_to_hull(const Dataset& dataset, const voctree::VOctree& tree, const Carved& carved, size_t i,
                 std::vector<float>& values);

// The metres that a pixel covers at a position, in the camera where it covers least.
double footprint_at(const Dataset& dataset, glm::dvec3 position);

}  // namespace neuvv::training
