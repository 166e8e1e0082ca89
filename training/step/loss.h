// The loss of a batch of traced tiles, and its derivative by the colour and alpha of every ray.
#pragma once

#include "render/volume/trace.h"
#include "shared/training.h"
#include "training/step/camera_colour.h"

namespace neuvv::training {

// The weights of the losses by name. From this table follow options (--lambda-grad), keys of checkpoint files
// (lambda_grad) and their help texts.
struct NamedLossWeight {
    const char* name;
    float LossWeights::*weight;
    const char* meaning;
};
constexpr NamedLossWeight kLossWeights[] = {
    {"grad", &LossWeights::grad, "Weight of the gradient loss L_grad"},
    {"point", &LossWeights::point, "Weight of the loss of each sample's own colour"},
    {"smooth", &LossWeights::smoothness, "Weight of the difference in opacity of neighbouring leaves"}};
constexpr LossWeights kDefaultLossWeights{.grad = 0.1f, .point = 0.2f, .smoothness = 5e-4f};
// The same but for the smoothness, which not every kind of step computes.
constexpr LossWeights kLossWeightsWithoutSmoothness = [] {
    LossWeights weights = kDefaultLossWeights;
    weights.smoothness = 0;
    return weights;
}();

// What the rays of a batch should see, and the loss with its derivatives; all in the order of the rays.
struct LossBatch {
    LossBatch(const gpu::Device& device, uint32_t tiles);

    // Per ray: premultiplied linear RGB and alpha of the foreground; alpha −1 where there is no pixel. Host-mapped.
    gpu::Buffer target;
    gpu::Buffer background;  // per ray: linear RGB; host-mapped
    gpu::Buffer adjoint;     // per ray: ∂L/∂(R, G, B, alpha)
    gpu::Buffer sums;        // per tile: (Σ rgb, Σ grad, pixels, unused)
    // Per tile a CameraColour: that of its camera (host-mapped), and the derivative by it. Only where colours are
    // refined.
    gpu::Buffer colours, colour_gradients;
};

// Writes cameras, tiles, targets and backgrounds of a batch into the buffers that the next step reads. No step may be
// running. The batch must fit (assert). `colours`: by camera, or none; where there are some, they are written too, and
// the targets become what the mean camera would see.
void load_batch(const Dataset& dataset, const Batch& batch, const render::RayBatch& rays, const LossBatch& loss_batch,
                const CameraColours& colours = {});

struct Loss {
    Loss(const gpu::Device& device, const render::RayBatch& rays, const LossBatch& batch);

    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// A pixel is the mean of samples² neighbouring rays, all of which have the pixel's target and background. `samples`
// must divide kTile (assert). With `colours`, the batch must have been loaded with colours.
void record_loss(gpu::Commands& commands, const Loss& loss, uint32_t tiles, const LossWeights& weights,
                 uint32_t samples = 1, bool colours = false);

}  // namespace neuvv::training
