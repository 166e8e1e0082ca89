// The smoothness loss on opacities of neighbouring leaves (training/shaders/smooth.comp), by search through all leaves.
#pragma once

#include <array>
#include <vector>

#include "voctree/voctree.h"

namespace neuvv::reference {

// The leaves beyond the centre of this leaf's six faces, UINT32_MAX where there is none. `finest` is the depth of the
// finest cells of a tree with this number of levels. Where a leaf is wider than these, the centre of a side is the
// upper one of the two centre cells.
std::array<uint32_t, 6> face_neighbours(const std::vector<voctree::LeafPosition>& positions, uint32_t leaf,
                                        uint32_t finest);

// L_i / λ of a leaf with this density (1/m) and edge (m), and neighbours of these densities (0 where there is none).
double smoothness(double sigma, double edge, const std::array<double, 6>& neighbours);

}  // namespace neuvv::reference
