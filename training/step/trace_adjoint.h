// The adjoint of trace: takes gradients from rays to the σ and SH of the slots that they crossed.
#pragma once

#include "render/volume/trace.h"
#include "shared/training.h"
#include "training/step/loss.h"

namespace neuvv::training {

// The gradients that rays give to slots, summed. The slice adjoint reads and clears them.
struct SliceGradients {
    // All gradients start at 0.
    SliceGradients(const gpu::Device& device, const render::Field& field, const render::Slice& slice);

    gpu::Buffer gradients;   // per slot gradient_stride floats
    gpu::Buffer max_weight;  // per slot bits of the largest blending weight of the step
    gpu::Buffer touched;     // slots that rays of the step reached
    gpu::Buffer touched_count;
    gpu::Buffer partials;  // per workgroup of slots: sums for the rows
};

// How many slots a training step can have: their gradients must fit one bound storage buffer of this device.
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

// Tiles and `stop` must be those of record_trace. Samples behind the one that ended a ray get no gradient. The point
// loss (ray_adjoint.glsl) of a ray is weighted by `pixel_share`, the ray's share in its pixel; rays whose ∂L/∂ray is 0
// have no point loss.
void record_trace_adjoint(gpu::Commands& commands, const TraceAdjoint& adjoint, uint32_t tiles, float stop,
                          const LossWeights& weights, float pixel_share);

}  // namespace neuvv::training
