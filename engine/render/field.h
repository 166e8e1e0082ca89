// A VOctree in device memory: what the slice, trace and direct passes read (layout: shared/field.h).
#pragma once

#include "gpu/buffer.h"
#include "shared/field.h"
#include "voctree/voctree.h"

namespace neuvv {

enum class WeightPrecision { kHalf, kFloat };  // shaders read either; training writes, so it needs kFloat

struct Field {
    Buffer top, nodes, children, weights, sigma_basis, gamma_basis;
    Buffer leaf_cells;   // per leaf: word of Slice::node_live and its bits there
    Buffer inner_cells;  // per node: mask of the cells that are nodes
    glm::vec3 box_min{0}, box_size{1};
    uint32_t node_levels = 1, leaf_count = 0, bases = 1, hh_degree = 0, frames = 1;
    uint32_t busy_planes = 1;  // the most planes of A_t or B_t at any t that are not 0; who moves A or B sets it to all

    uint32_t basis_planes() const { return (bases + 3) / 4; }
    uint32_t planes() const { return 2 * basis_planes() + hh_count(hh_degree); }
};

// The tree must be sound (defect_of(tree) empty). Throws RuntimeFailure where the device cannot hold it.
Field upload_field(const Device& device, const VOctree& tree, WeightPrecision precision);

// The weights in plane order, four floats a texel, and back.
std::vector<float> weights_to_planes(const VOctree& tree);
void weights_from_planes(const std::vector<float>& planes, VOctree& tree);

}  // namespace neuvv
