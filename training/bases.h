// The temporal bases A and B as training begins, and leaf weights for a wanted course over time.
#pragma once

#include <cstdint>
#include <vector>

#include "voctree/voctree.h"

namespace neuvv::training {

// frames × bases hat functions: column c is 1 at its knot, falls to 0 at its neighbours'; knots are spread evenly over
// the clip. Rows sum to 1. With bases = frames it is the identity. Needs 1 ≤ bases ≤ frames.
std::vector<float> hat_basis(uint32_t frames, uint32_t bases);

// Whether A and B are identities: then a leaf's c-th w^σ and w^γ are those of frame c, and of no other.
bool has_basis_per_frame(const voctree::VOctree& tree);

// w^γ that sweeps γ from 0.1π to 0.9π over the clip under hat_basis: H_n·· then differ from the first frame to the
// last, and no leaf starts at γ = π/2, where odd n vanish.
std::vector<float> initial_gamma_weights(uint32_t bases);

// Least squares: weights w with basis·w ≈ a course of values over the frames.
class BasisSolver {
  public:
    BasisSolver(const std::vector<float>& basis, uint32_t frames, uint32_t bases);
    // `values`: frames; `weights`: bases.
    void solve(const float* values, float* weights) const;

  private:
    uint32_t frames_, bases_;
    std::vector<float> inverse_;  // bases × frames
};

}  // namespace neuvv::training
