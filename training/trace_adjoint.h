// Trace, backwards: from rays to the σ and SH of the slots they crossed.
#pragma once

#include "render/trace.h"
#include "shared/training.h"
#include "training/loss.h"

namespace neuvv::training {

// What rays say to slots, summed; slice_adjoint reads and clears it.
struct SliceGradients {
    // Starts out clear.
    SliceGradients(const gpu::Device& device, const render::Field& field, const render::Slice& slice);

    gpu::Buffer gradients;   // per slot gradient_stride floats
    gpu::Buffer max_weight;  // per slot bits of the largest blending weight of the step
    gpu::Buffer touched;     // slots that rays of the step reached
    gpu::Buffer touched_count;
    gpu::Buffer partials;  // per workgroup of slots: sums for the rows
};

// The most slots whose gradients fit one bound storage buffer of this device.
uint32_t max_training_slots(const gpu::Device& device, uint32_t hh_degree);

enum class AtomicAdd { kNative, kCompareAndSwap };
AtomicAdd best_atomic_add(const gpu::Device& device);

struct TraceAdjoint {
    TraceAdjoint(const gpu::Device& device, const render::Field& field, const render::Slice& slice,
                 const render::RayBatch& rays, const LossBatch& batch, const SliceGradients& gradients,
                 AtomicAdd atomics);

    const render::Field& field;
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// Same tiles and `stop` as record_trace. Behind the sample that ended a ray there is no gradient. `share`: what a ray
// takes of its pixel, times which its point loss (trace_adjoint.glsl) weighs; rays without an ∂L/∂ray take no part in
// that loss.
void record_trace_adjoint(gpu::Commands& commands, const TraceAdjoint& adjoint, uint32_t tiles, float stop,
                          const LossWeights& weights, float pixel_share);

}  // namespace neuvv::training
