// A step of training the paper's way, forwards and backwards without a slice: the reference that a TrainingStep is
// measured and checked against. No weight moves.
#pragma once

#include "training/direct_adjoint.h"
#include "training/step.h"

namespace neuvv {

class DirectStep {
  public:
    // As TrainingStep.
    DirectStep(const Device& device, const VOctree& tree, uint32_t cameras, uint32_t tiles, AtomicAdd atomics);

    const RayBatch& rays() const { return rays_; }
    const LossBatch& batch() const { return batch_; }
    const Field& field() const { return field_; }
    const Buffer& gradients() const { return gradients_; }  // ∂L/∂weights of the last run, laid out as the field's

    // Blocks until it is done. Takes frame, tiles, samples, stop and the rays' losses from the settings.
    void run(const StepSettings& settings);
    std::vector<PassTime> pass_times() const { return commands_.pass_times(); }

  private:
    Field field_;
    LiveLeaves live_;  // its rows alone
    RayBatch rays_;
    LossBatch batch_;
    Buffer gradients_;
    LiveFinder finder_;
    DirectTracer tracer_;
    Loss loss_;
    DirectAdjoint adjoint_;
    Commands commands_;
};

}  // namespace neuvv
