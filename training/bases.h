// The temporal bases A and B with which training begins, and weights of leaves that give chosen values over time.
#pragma once

#include <cstdint>
#include <vector>

#include "voctree/voctree.h"

namespace neuvv::training {

// A matrix of frames × bases numbers, row by row, whose columns are hat functions: column c is 1 at its knot and falls
// to 0 at the neighbouring knots. Knots are spread evenly over the clip. Each row sums to 1. With bases = frames the
// matrix is the identity. Needs 1 ≤ bases ≤ frames (assert).
std::vector<float> hat_basis(uint32_t frames, uint32_t bases);

// Whether A and B are identities. Then element c of a leaf's w^σ and w^γ belongs to frame c alone.
bool has_basis_per_frame(const voctree::VOctree& tree);

// The σ of a leaf in every frame before relu, from its w^σ at the beginning of `leaf`. `values`: one per frame.
void sigma_of_frames(const voctree::VOctree& tree, const float* leaf, std::vector<float>& values);

// The w^γ with which γ goes from 0.1π to 0.9π over the clip under hat_basis. The functions H_n·· then differ between
// the first frame and the last. With a single basis γ is 0.3π, as functions of odd n vanish at γ = π/2.
std::vector<float> initial_gamma_weights(uint32_t bases);

// Finds weights w with basis · w ≈ given values over the frames, by least squares. `basis`: frames × bases.
class BasisSolver {
  public:
    BasisSolver(const std::vector<float>& basis, uint32_t frames, uint32_t bases);
    // Reads one value per frame and writes one weight per basis.
    void solve(const float* values, float* weights) const;

  private:
    uint32_t frames_, bases_;
    std::vector<float> inverse_;  // bases × frames
};

}  // namespace neuvv::training
