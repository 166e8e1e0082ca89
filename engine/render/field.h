// A VOctree in device memory: what the slice, trace and direct passes read (layout: shared/field.h).
#pragma once

#include "gpu/buffer.h"
#include "shared/field.h"
#include "voctree/voctree.h"

namespace neuvv::render {

enum class WeightPrecision { kHalf, kFloat };  // shaders read either; training writes, so it needs kFloat

struct Field {
    gpu::Buffer top, nodes, children, weights, sigma_basis, gamma_basis;
    gpu::Buffer leaf_cells, node_cells;  // per leaf and node: word of LiveLeaves::node_live and its bits there
    gpu::Buffer leaf_positions,
        node_positions;                 // per leaf and node: (x | y << 16, z | depth << 16), in cells of its own size
    gpu::Buffer inner_cells;            // per node: mask of the cells that are nodes
    std::vector<uint32_t> level_begin;  // first node of each level; at the end the number of nodes
    glm::vec3 box_min{0}, box_size{1};
    uint32_t node_levels = 1, top_levels = 0;       // of the walk tree, whose box this is
    uint32_t levels_above = 0;                      // octree levels by which its root lies above the tree's
    uint32_t coarsest_level = 1, finest_level = 1;  // of the leaves, from the tree's root, which is level 0
    TopBox top_box;
    glm::vec3 leaves_min{0}, leaves_max{1};  // metres: a box around all leaves
    float leaf_diagonal = 0;                 // metres, of the average leaf
    uint32_t leaf_count = 0, bases = 1, hh_degree = 0, frames = 1;
    uint32_t busy_planes = 1;  // the most planes of A_t or B_t at any t that are not 0; who moves A or B sets it to all

    uint32_t node_count() const { return level_begin.back(); }
    uint32_t basis_planes() const { return (bases + 3) / 4; }
    uint32_t planes() const { return 2 * basis_planes() + hh_count(hh_degree); }
};

// The tree must be sound (defect_of(tree) empty). Throws RuntimeFailure where the device cannot hold it.
Field upload_field(const gpu::Device& device, const voctree::VOctree& tree, WeightPrecision precision);

// The weights in plane order, four floats a texel, and back.
std::vector<float> weights_to_planes(const voctree::VOctree& tree);
void weights_from_planes(const std::vector<float>& planes, voctree::VOctree& tree);

}  // namespace neuvv::render
