// The Video Octree: a dynamic radiance field as leaves of a sparse octree over an axis-aligned box.
//
// At world position x inside leaf k, frame t (continuous, 0..frames-1) and unit direction d of the ray:
//   σ = relu(A_t·w^σ_k)                               [1/m]            (errata 9)
//   γ = π·sigmoid(B_t·w^γ_k)                          hyper angle      (errata 9)
//   c = sigmoid(Σ_nlm w^HH_k,nlm H_nlm(d, γ))         linear RGB       (errata 7, 8)
// Rows A_t, B_t of fractional t are interpolated linearly (errata 9). Errata are listed in engine/ERRATA.md.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "shared/hh_counts.h"
#include "shared/tree.h"

namespace neuvv::voctree {

// What a tree may hold at most, in memory and in a file.
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

    std::vector<float> sigma_basis;  // A, frames × bases, row-major
    std::vector<float> gamma_basis;  // B, frames × bases
    std::vector<float> weights;  // leaf_count × weights_per_leaf(): [w^σ (C) | w^γ (C) | w^HH R (N) | G (N) | B (N)]

    uint32_t weights_per_leaf() const { return 2 * bases + 3 * hh_count(hh_degree); }
    float* leaf(uint32_t index) { return &weights[size_t{index} * weights_per_leaf()]; }
    const float* leaf(uint32_t index) const { return &weights[size_t{index} * weights_per_leaf()]; }
};

// One leaf's place: cell coordinates at its own depth (0..2^depth−1 on each axis) and octree depth (1..2·node_levels).
struct LeafPosition {
    uint32_t x, y, z;
    uint32_t depth;
};

// Morton code of a place's first cell at the finest depth (at least the place's own): the order of leaves on walks.
uint64_t first_cell(const LeafPosition& place, uint32_t finest_depth);

// Builds nodes and children of a tree whose leaf i stands at places[i]. Places must not overlap and must fit
// node_levels (assert). Weights are left to the caller (resized, zero).
void build_topology(VOctree& tree, const std::vector<LeafPosition>& places);

// The same but for the weights, which stay as they are.
void build_nodes(VOctree& tree, const std::vector<LeafPosition>& places);

// The inverse: where each leaf stands, by leaf index.
std::vector<LeafPosition> leaf_positions(const VOctree& tree);

// build_topology, where leaf i takes the weights at `from[i]`, which may point into the tree's own.
void replace_leaves(VOctree& tree, const std::vector<LeafPosition>& places, const std::vector<const float*>& from);

// Index of the leaf that holds this tree-space position in [0,1)³, or UINT32_MAX where it is empty.
uint32_t find_leaf(const VOctree& tree, glm::dvec3 position_tree);

// Everything a reader of a foreign file must know before a shader walks the tree: sizes agree, every child index is in
// range, no node is reached twice (so walks end), every leaf is reached (once, or as the eight cells of one octant),
// all numbers are finite. Returns what is wrong, or an empty string.
std::string defect_of(const VOctree& tree);

// The part of it that needs no weights, rows or box: counts, nodes, children.
std::string defect_of_topology(const VOctree& tree);

}  // namespace neuvv::voctree
