// The temporal bases A and B on the host: the tables with which training begins, their rows at a time, and what leaves
// are by them. shared/temporal_basis.h says which rows a time reads.
#pragma once

#include <vector>

#include "shared/temporal_basis.h"
#include "voctree/voctree.h"

namespace neuvv::voctree {

// A table of frames × bases numbers, row by row, whose columns are hat functions: column c is 1 at its knot and falls
// to 0 at the neighbouring knots. Knots are spread evenly over the clip. Each row sums to 1. With bases = frames the
// table is the identity. Needs 1 ≤ bases ≤ frames (assert).
std::vector<float> hat_basis(uint32_t frames, uint32_t bases);

// Whether A and B are identities. Then element c of a leaf's w^σ and w^γ belongs to frame c alone.
bool has_basis_per_frame(const VOctree& tree);

// The w^γ with which γ goes from 0.1π to 0.9π over the clip under hat_basis. The functions H_n·· then differ between
// the first frame and the last. With a single basis γ is 0.3π, as functions of odd n vanish at γ = π/2.
std::vector<float> initial_gamma_weights(uint32_t bases);

// The row of a table at a frame, which may lie between two.
std::vector<float> row_at(const std::vector<float>& table, uint32_t bases, double frame, uint32_t frames);

// The rows A_t and B_t at a frame.
struct RowsAtTime {
    RowsAtTime(const VOctree& tree, double frame);
    std::vector<float> sigma, gamma;  // one for each basis
};

// The element of a leaf's σ or hyper angle before relu or sigmoid: a row times its weights, `leaf` (VOctree::leaf) or
// behind that the w^γ. `row`: one number for each basis.
float row_product(const float* row, const float* weights, uint32_t bases);

// An entry of A or B that is not 0. Where each frame has its own basis, there is one such entry per frame.
struct BasisEntry {
    uint32_t frame, basis;
    float value;
};
std::vector<BasisEntry> basis_entries(const std::vector<float>& rows, uint32_t bases);

// Computes σ of a leaf at each frame, 1/m, from its weights (VOctree::leaf). `entries` are those of A; `sigma` must
// have tree.frames elements.
void density_of_frames(const float* leaf, const std::vector<BasisEntry>& entries, std::vector<float>& sigma);

// The σ of a leaf in every frame before relu, from its w^σ at the beginning of `leaf`. `values`: one per frame.
void sigma_of_frames(const VOctree& tree, const float* leaf, std::vector<float>& values);

}  // namespace neuvv::voctree
