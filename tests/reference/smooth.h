// The smoothness loss on opacities of neighbouring leaves (training/shaders/smooth.comp), by search through all leaves.
#pragma once

#include <array>
#include <vector>

#include "voctree/voctree.h"

namespace neuvv::reference {

// The leaves beyond the middle of this leaf's six faces, UINT32_MAX where there is none. `finest`: depth of the finest
// cells that a tree of its levels has; where a leaf is wider than those, its middle is the upper of the middle two.
std::array<uint32_t, 6> face_neighbours(const std::vector<voctree::LeafPosition>& places, uint32_t leaf,
                                        uint32_t finest);

// L_i / λ of a leaf of this density (1/m) and edge (m), its neighbours' densities given (0: none).
double smoothness(double sigma, double edge, const std::array<double, 6>& neighbours);

}  // namespace neuvv::reference
