// The smoothness loss (smooth.comp): neighbouring leaves of like opacity.
#pragma once

#include "training/slice_adjoint.h"

namespace neuvv::training {

class Smoother {
  public:
    Smoother(const gpu::Device& device, const render::Field& field, const render::Slice& slice,
             const SliceGradients& gradients);

  private:
    friend void record_smooth(gpu::Commands&, const Smoother&, float);
    const render::Field& field_;
    const SliceGradients& gradients_;
    gpu::ComputePass pass_;
    gpu::BindingSet set_;
};

// Adds λ ∂L/∂σ to the gradients of the slots that record_touched listed.
void record_smooth(gpu::Commands& commands, const Smoother& smoother, float lambda);

}  // namespace neuvv::training
