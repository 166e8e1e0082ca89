// The smoothness loss (smooth.comp): neighbouring leaves of like opacity.
#pragma once

#include "training/slice_adjoint.h"

namespace neuvv {

class Smoother {
  public:
    Smoother(const Device& device, const Field& field, const Slice& slice, const SliceGradients& gradients);

  private:
    friend void record_smooth(Commands&, const Smoother&, float);
    const Field& field_;
    const SliceGradients& gradients_;
    ComputePass pass_;
    BindingSet set_;
};

// Adds λ ∂L/∂σ to the gradients of the slots that record_touched listed.
void record_smooth(Commands& commands, const Smoother& smoother, float lambda);

}  // namespace neuvv
