// Weights of leaves that give chosen values over time.
#pragma once

#include <cstdint>
#include <vector>

#include "voctree/temporal_basis.h"

namespace neuvv::training {

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
