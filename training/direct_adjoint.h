// The paper's backward pass, from rays to every weight of the leaves they crossed, without a slice: what the slice's
// adjoints are measured and checked against.
#pragma once

#include "render/trace.h"
#include "training/loss.h"
#include "training/trace_adjoint.h"

namespace neuvv::training {

struct DirectAdjoint {
    // `gradients`: as many bytes as field.weights, laid out as they are.
    DirectAdjoint(const gpu::Device& device, const render::Field& field, const render::LiveLeaves& live,
                  const render::RayBatch& rays, const LossBatch& batch, const gpu::Buffer& gradients,
                  AtomicAdd atomics);

    const render::Field& field;
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// As record_trace_adjoint, after record_direct. Adds to the gradients. Needs only the rows of a slice.
void record_direct_adjoint(gpu::Commands& commands, const DirectAdjoint& adjoint, uint32_t tiles, float stop,
                           const LossWeights& weights, float pixel_share);

}  // namespace neuvv::training
