// The Video Octree: a dynamic radiance field as leaves of a sparse octree over an axis-aligned box.
//
// At world position x inside leaf k, frame t (continuous, 0..frames-1) and unit direction d of the ray:
//   σ = relu(A_t·w^σ_k)                               [1/m]            (errata 9)
//   γ = π·sigmoid(B_t·w^γ_k)                          hyper angle      (errata 9)
//   c = sigmoid(Σ_nlm w^HH_k,nlm H_nlm(d, γ))         linear RGB       (errata 7, 8), or sRGB (has_srgb_colours)
// Rows A_t, B_t of fractional t are interpolated linearly (errata 9). Errata are listed in engine/ERRATA.md.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "shared/hh_counts.h"
#include "shared/tree.h"
#include "slice/slice.h"

namespace neuvv::voctree {

// Limits of a tree in memory and in a file.
constexpr uint32_t kMaxNodes = 1u << 26;
constexpr uint32_t kMaxLeaves = 1u << 27;
constexpr uint32_t kMaxFrames = 100000;

struct VOctree {
    // Tree space is [0,1)³; world = box_min + tree * box_size (metres). The box's cells need not be cubes.
    glm::vec3 box_min{0};
    glm::vec3 box_size{1};

    uint32_t node_levels = 1;        // levels of TreeNode; finest cells are box_size / 4^node_levels
    std::vector<TreeNode> nodes;     // nodes[0] is the root
    std::vector<uint32_t> children;  // see shared/tree.h
    uint32_t leaf_count = 0;

    uint32_t bases = 31;     // C
    uint32_t hh_degree = 2;  // n_max
    uint32_t frames = 1;     // N: rows of A and B
    float fps = 25;          // frames per second of the recording
    // Colours are sRGB and are composited as such along a ray, whose sum is decoded to linear light: PlenOctrees for
    // players. No file has such a tree.
    bool has_srgb_colours = false;

    std::vector<float> sigma_basis;  // A, frames × bases, row-major
    std::vector<float> gamma_basis;  // B, frames × bases
    std::vector<float> weights;  // leaf_count × weights_per_leaf(): [w^σ (C) | w^γ (C) | w^HH R (N) | G (N) | B (N)]

    uint32_t weights_per_leaf() const { return 2 * bases + 3 * hh_count(hh_degree); }
    float* leaf(uint32_t index) { return &weights[size_t{index} * weights_per_leaf()]; }
    const float* leaf(uint32_t index) const { return &weights[size_t{index} * weights_per_leaf()]; }
};

// The position of a leaf: coordinates of its cell among the cells of its depth (0..2^depth−1 on each axis).
struct LeafPosition {
    uint32_t x, y, z;
    uint32_t depth;  // octree depth, 1..2·node_levels
};

// The Morton code of the leaf's first cell at `finest_depth`, which is at least the leaf's depth. The codes are in the
// order in which a walk over the tree meets the leaves.
uint64_t first_cell(const LeafPosition& position, uint32_t finest_depth);
// The inverse for a code at the leaf's own depth.
LeafPosition position_of(uint64_t code, uint32_t depth);

// Builds nodes and children of a tree whose leaf i is at positions[i]. The leaves must not overlap and must fit
// node_levels (assert). The weights are resized and set to 0.
void build_topology(VOctree& tree, const std::vector<LeafPosition>& positions);

// The same, but leaves the weights as they are.
void build_nodes(VOctree& tree, const std::vector<LeafPosition>& positions);

// The inverse: the position of each leaf, by leaf index.
std::vector<LeafPosition> leaf_positions(const VOctree& tree);

// The mean of the three edges of a leaf of this octree depth, metres.
inline float leaf_edge_m(const VOctree& tree, uint32_t depth) {
    return slice::edge_m(tree.box_size, depth);
}

// As build_topology, but leaf i gets the weights (weights_per_leaf() numbers) at `from[i]`, which may point into
// tree.weights.
void replace_leaves(VOctree& tree, const std::vector<LeafPosition>& positions, const std::vector<const float*>& from);

// The index of the leaf that contains this tree-space position, or UINT32_MAX where there is none.
uint32_t find_leaf(const VOctree& tree, glm::dvec3 position_tree);

// What makes a tree unsafe for a shader to walk, or an empty string. Checks that sizes agree, that every child index is
// in range, that no node is reached twice (so walks end), that every leaf is reached (once, or as the eight cells of
// one octant), and that all numbers are finite.
std::string defect_of(const VOctree& tree);

// The part of defect_of that needs no weights, rows or box: counts, nodes, children.
std::string defect_of_topology(const VOctree& tree);

}  // namespace neuvv::voctree
