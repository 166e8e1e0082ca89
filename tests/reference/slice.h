// Slice: from a leaf's weights to density and spherical harmonics at one time (errata 7, 9), and the adjoint.
//
//   σ = relu(A_t·w^σ),  γ = π sigmoid(B_t·w^γ),  k_lm = Σ_n w_nlm R_nl(γ) for each of R, G, B
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include "voctree/voctree.h"

namespace neuvv::reference {

inline double sigmoid(double x) {
    return 1 / (1 + std::exp(-x));
}

// One row of SH coefficients for each of R, G, B; entries beyond sh_count(degree) are 0.
using ShCoefficients = std::array<std::array<double, kMaxShCount>, 3>;

// The rows of A and B between which a continuous frame lies: row(t) = (1−blend) row(first) + blend row(second).
struct FrameRows {
    uint32_t first = 0;
    uint32_t second = 0;
    double blend = 0;
};
FrameRows frame_rows(double frame, uint32_t frames);  // frame is clamped to [0, frames−1]

// A_t or B_t, from the tree's sigma_basis or gamma_basis.
std::vector<double> basis_row(const std::vector<float>& basis, uint32_t bases, const FrameRows& rows);

struct LeafWeights {
    std::vector<double> sigma;              // w^σ, C
    std::vector<double> gamma;              // w^γ, C
    std::array<std::vector<double>, 3> hh;  // w^HH of R, G, B, N each
};
LeafWeights leaf_weights(const voctree::VOctree& tree, uint32_t leaf);

struct LeafSlice {
    double sigma = 0;  // 1/m
    double gamma = 0;  // hyper angle, kept for the direct evaluation
    ShCoefficients k{};
};
LeafSlice slice(const LeafWeights& weights, const std::vector<double>& row_a, const std::vector<double>& row_b,
                uint32_t degree);
std::vector<LeafSlice> slice_tree(const voctree::VOctree& tree, double frame);  // by leaf index

// Derivatives of a loss by a leaf's weights, and this leaf's share of those by the rows A_t and B_t.
struct SliceGradient {
    LeafWeights weights;
    std::vector<double> row_a;
    std::vector<double> row_b;
};
// d_sigma and d_k are the loss's derivatives by the slice. The subgradient of relu at 0 is 0.
SliceGradient slice_adjoint(const LeafWeights& weights, const std::vector<double>& row_a,
                            const std::vector<double>& row_b, uint32_t degree, double d_sigma,
                            const ShCoefficients& d_k);

}  // namespace neuvv::reference
