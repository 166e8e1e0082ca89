// A VOctree in device memory: what the slice, trace and direct passes read (layout: shared/field.h).
#pragma once

#include <cassert>
#include <memory>

#include "gpu/buffer.h"
#include "render/volume/slices/walk_tree.h"
#include "shared/field.h"
#include "voctree/voctree.h"

namespace neuvv::render {

// Shaders read both; training writes weights, so it needs kFloat, which is one buffer.
enum class WeightPrecision { kHalf, kFloat };

struct SliceTrees;

struct Field {
    gpu::Buffer nodes, sigma_basis, gamma_basis;
    // One buffer, unless they are longer than what the device binds or allocates at once. Then, in the storage profile,
    // shaders read them by addresses, and they are parts of 2^part_planes_log2 planes, the last of fewer.
    std::vector<gpu::Buffer> weights;
    bool weights_by_address = false;
    uint32_t part_planes_log2 = 0;  // of weights_by_address
    // The walk tree's top grid, and after it the children of all nodes. A node's first_child is an index into both.
    gpu::Buffer links;
    // Per leaf: the index of a 32-bit word of LiveLeaves::node_live, and the bits of the leaf in it.
    gpu::Buffer leaf_cells;
    // Per node the mask of the cells that are nodes, and after all these per node the same as in leaf_cells.
    gpu::Buffer node_cells;
    // Per leaf and node: (x | y << 16, z | depth << 16), in cells of its own size.
    gpu::Buffer leaf_positions, node_positions;
    std::vector<uint32_t> level_begin;  // the first node of each level, then the number of nodes
    glm::vec3 box_min{0}, box_size{1};
    uint32_t node_levels = 1, top_levels = 0;       // of the walk tree (walk_tree.h), whose box this is
    uint32_t levels_above = 0;                      // octree levels from its root to the VOctree's root
    uint32_t coarsest_level = 1, finest_level = 1;  // of leaves; the VOctree's root is level 0
    TopBox top_box{};
    glm::vec3 leaves_min{0}, leaves_max{1};  // metres: the bounds of all leaves
    float leaf_diagonal = 0;                 // metres, of the average leaf
    uint32_t leaf_count = 0, bases = 1, hh_degree = 0, frames = 1;
    bool half_weights = false;      // whether `weights` are fp16
    bool has_srgb_colours = false;  // VOctree
    // The largest number of planes of A_t or B_t that are not 0 at any t. Code that changes A or B must set it to
    // basis_planes().
    uint32_t busy_planes = 1;
    // The slice of a field of one frame that came as one (slice_upload.h). Then there are neither weights nor bases,
    // nodes and leaf_cells are empty, and node_cells has masks alone. Null: slices are built from the weights.
    std::shared_ptr<const SliceTrees> slice;
    // The same clip with fewer and larger leaves, each at least an octree depth coarser than the one before
    // (field_levels.h).
    std::vector<Field> coarser;

    uint32_t node_count() const { return level_begin.back(); }
    uint64_t live_bytes() const { return uint64_t{8} * node_count(); }  // of LiveLeaves::node_live
    uint32_t basis_planes() const { return (bases + 3) / 4; }
    // All of them, where they are one buffer, as those of WeightPrecision::kFloat are.
    const gpu::Buffer& whole_weights() const {
        assert(weights.size() == 1);
        return weights[0];
    }
    // What passes bind as the weights. With weights_by_address they do not read it, and another buffer fills the
    // binding.
    const gpu::Buffer& bound_weights() const { return weights_by_address ? links : weights[0]; }
    uint32_t planes() const { return 2 * basis_planes() + hh_count(hh_degree); }
};

// The tree must be sound (defect_of(tree) is empty). Throws RuntimeFailure where the device lacks memory or a limit is
// exceeded.
Field upload_field(const gpu::Device& device, const voctree::VOctree& tree, WeightPrecision precision);

// Sets what a field has of the shape of its tree, but for buffers; box_min must be set. `box_size`: of the box that the
// tree was given, metres.
void set_shape(Field& field, const WalkShape& shape, glm::vec3 box_size);

// The bytes of its buffers and of those of coarser levels.
uint64_t device_bytes(const Field& field);

// Converts the weights of all leaves to planes (texel plane · leaf_count + leaf, four floats a texel), and back.
std::vector<float> weights_to_planes(const voctree::VOctree& tree);
void weights_from_planes(const std::vector<float>& planes, voctree::VOctree& tree);

}  // namespace neuvv::render
