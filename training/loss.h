// The loss of a batch of traced tiles, and its derivative by every ray.
#pragma once

#include "render/trace.h"
#include "shared/training.h"
#include "training/batch.h"

namespace neuvv::training {

// By name, for options (--lambda-grad), records (lambda_grad) and what a user reads of them.
struct NamedLossWeight {
    const char* name;
    float LossWeights::*weight;
    const char* meaning;
};
constexpr NamedLossWeight kLossWeights[] = {
    {"grad", &LossWeights::grad, "Weight of the gradient loss L_grad"},
    {"point", &LossWeights::point, "Weight of the loss of each sample's own colour"},
    {"smooth", &LossWeights::smoothness, "Weight of the difference in opacity of neighbouring leaves"}};
constexpr LossWeights kDefaultLossWeights{0.1f, 0.2f, 5e-4f};

// What the rays of a batch should have seen, in the rays' order; and what the loss says.
struct LossBatch {
    LossBatch(const gpu::Device& device, uint32_t tiles);

    gpu::Buffer
        target;  // per ray premultiplied linear RGB and alpha of the foreground, alpha −1 off the image; host-mapped
    gpu::Buffer background;  // per ray linear RGB; host-mapped
    gpu::Buffer adjoint;     // per ray ∂L/∂(R, G, B, alpha)
    gpu::Buffer sums;        // per tile (Σ rgb, Σ grad, pixels, unused)
};

// Puts a batch of this data set's images where the next step reads it; none may be under way.
void load_batch(const Dataset& dataset, const Batch& batch, const render::RayBatch& rays, const LossBatch& loss_batch);

struct Loss {
    Loss(const gpu::Device& device, const render::RayBatch& rays, const LossBatch& batch);

    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// A pixel is the mean of samples² neighbouring rays, which have its target
// and background in common; `samples` divides kTile.
void record_loss(gpu::Commands& commands, const Loss& loss, uint32_t tiles, const LossWeights& weights,
                 uint32_t samples = 1);

}  // namespace neuvv::training
