// How dense leaves are in each frame: what decides how much of their numbers an image shows.
#pragma once

#include <vector>

#include "voctree/voctree.h"

namespace neuvv::voctree {

// A number of A or B that is not 0. Where each frame has a basis of its own, one a frame is.
struct BasisEntry {
    uint32_t frame, basis;
    float value;
};
std::vector<BasisEntry> basis_entries(const std::vector<float>& rows, uint32_t bases);

// σ of a leaf at each frame, 1/m: `sigma` has tree.frames numbers. `entries` are those of A.
void density_of_frames(const float* leaf, const std::vector<BasisEntry>& entries, std::vector<float>& sigma);

// The mean of a leaf's three edges, metres.
float leaf_edge_m(const VOctree& tree, uint32_t depth);

}  // namespace neuvv::voctree
