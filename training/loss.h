// The loss of a batch of traced tiles, and its derivative by every ray.
#pragma once

#include "render/trace.h"
#include "shared/training.h"
#include "training/batch.h"

namespace neuvv::training {

// What the rays of a batch should have seen, in the rays' order; and what the loss says.
struct LossBatch {
    LossBatch(const gpu::Device& device, uint32_t tiles);

    gpu::Buffer
        target;  // per ray premultiplied linear RGB and alpha of the foreground, alpha −1 off the picture; host-mapped
    gpu::Buffer background;  // per ray linear RGB; host-mapped
    gpu::Buffer adjoint;     // per ray ∂L/∂(R, G, B, alpha)
    gpu::Buffer sums;        // per tile (Σ rgb, Σ grad, pixels, unused)
};

// Puts a batch of this data set's pictures where the next step reads it; none may be under way.
void load_batch(const Dataset& dataset, const Batch& batch, const render::RayBatch& rays, const LossBatch& loss_batch);

struct Loss {
    Loss(const gpu::Device& device, const render::RayBatch& rays, const LossBatch& batch);

    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// `lambda_grad`: weight of L_grad (errata 16). A pixel is the mean of samples² neighbouring rays, which have its target
// and background in common; `samples` divides kTile.
void record_loss(gpu::Commands& commands, const Loss& loss, uint32_t tiles, float lambda_grad, uint32_t samples = 1);

}  // namespace neuvv::training
