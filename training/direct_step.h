// A step of training the paper's way, forwards and backwards without a slice: the reference that a TrainingStep is
// measured and checked against. No weight moves.
#pragma once

#include "training/direct_adjoint.h"
#include "training/step.h"

namespace neuvv::training {

class DirectStep {
  public:
    // As TrainingStep.
    DirectStep(const gpu::Device& device, const voctree::VOctree& tree, uint32_t cameras, uint32_t tiles,
               AtomicAdd atomics);

    const render::RayBatch& rays() const { return rays_; }
    const LossBatch& batch() const { return batch_; }
    const render::Field& field() const { return field_; }
    const gpu::Buffer& gradients() const { return gradients_; }  // ∂L/∂weights of the last run, laid out as the field's

    // Blocks until it is done. Takes frame, tiles, samples, stop and the rays' losses from the settings.
    void run(const StepSettings& settings);
    std::vector<gpu::PassTime> pass_times() const { return commands_.pass_times(); }

  private:
    render::Field field_;
    render::LiveLeaves live_;  // its rows alone
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
