// A training step as the paper does it: forwards and backwards without a slice. It is the reference for the speed and
// the correctness of TrainingStep, and moves no weights.
#pragma once

#include "training/step/direct_adjoint.h"
#include "training/step/step.h"

namespace neuvv::training {

class DirectStep {
  public:
    // Parameters and errors are those of TrainingStep.
    DirectStep(const gpu::Device& device, const voctree::VOctree& tree, uint32_t cameras, uint32_t tiles,
               AtomicAdd atomics);

    const render::RayBatch& rays() const { return rays_; }
    const LossBatch& batch() const { return batch_; }
    const render::Field& field() const { return field_; }
    // ∂L/∂weights of the last run, laid out as the field's weights.
    const gpu::Buffer& gradients() const { return gradients_; }

    // Runs one step and waits for it. Of the settings it uses frame, tiles, samples, stop and the weights of the losses
    // of rays.
    void run(const StepSettings& settings);
    std::vector<gpu::PassTime> pass_times() const { return commands_.pass_times(); }

  private:
    render::Field field_;
    render::LiveLeaves live_;  // only its rows are used
    render::RayBatch rays_;
    LossBatch batch_;
    gpu::Buffer gradients_;
    render::LiveFinder finder_;
    render::DirectTracer tracer_;
    Loss loss_;
    DirectAdjoint adjoint_;
    gpu::Commands commands_;
};

}  // namespace neuvv::training
