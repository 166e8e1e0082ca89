// The paper's backward pass: from rays to every weight of the leaves that they crossed, without a slice. It is the
// reference for the speed and the correctness of the slice's adjoints.
#pragma once

#include "render/volume/trace.h"
#include "training/step/loss.h"
#include "training/step/trace_adjoint.h"

namespace neuvv::training {

struct DirectAdjoint {
    // `gradients` has as many bytes as field.weights and the same layout.
    DirectAdjoint(const gpu::Device& device, const render::Field& field, const render::LiveLeaves& live,
                  const render::RayBatch& rays, const LossBatch& batch, const gpu::Buffer& gradients,
                  AtomicAdd atomics);

    const render::Field& field;
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// Like record_trace_adjoint, but after record_direct, and adds to the gradients of weights. Of a slice it needs only
// the rows A_t and B_t.
void record_direct_adjoint(gpu::Commands& commands, const DirectAdjoint& adjoint, uint32_t tiles, float stop,
                           const LossWeights& weights, float pixel_share);

}  // namespace neuvv::training
