// The smoothness loss (smooth.comp): neighbouring leaves should have similar opacities.
#pragma once

#include "training/step/slice_adjoint.h"

namespace neuvv::training {

struct Smoother {
    Smoother(const gpu::Device& device, const render::Field& field, const render::Slice& slice,
             const SliceGradients& gradients);

    const render::Field& field;
    const SliceGradients& gradients;
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// Adds weights.smoothness · share · ∂L/∂σ to the gradients of the slots that record_touched listed.
void record_smooth(gpu::Commands& commands, const Smoother& smoother, const LossWeights& weights, float pixel_share);

}  // namespace neuvv::training
