// The density of leaves in each frame, which decides how much a leaf, and so the precision of its weights, matters in
// an image.
#pragma once

#include <vector>

#include "voctree/voctree.h"

namespace neuvv::voctree {

// An entry of A or B that is not 0. Where each frame has its own basis, there is one such entry per frame.
struct BasisEntry {
    uint32_t frame, basis;
    float value;
};
std::vector<BasisEntry> basis_entries(const std::vector<float>& rows, uint32_t bases);

// Computes σ of a leaf at each frame, 1/m, from its weights (VOctree::leaf). `entries` are those of A; `sigma` must
// have tree.frames elements.
void density_of_frames(const float* leaf, const std::vector<BasisEntry>& entries, std::vector<float>& sigma);

// The mean of the three edges of a leaf of this octree depth, metres.
float leaf_edge_m(const VOctree& tree, uint32_t depth);

}  // namespace neuvv::voctree
