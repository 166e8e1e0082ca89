// One step of training on the device: a batch of tiles of one frame, forwards and backwards.
#pragma once

#include <optional>

#include "training/step/gradient_records.h"
#include "training/step/loss.h"
#include "training/step/slice_adjoint.h"
#include "training/step/smooth.h"
#include "training/step/team.h"
#include "training/step/touched.h"
#include "training/step/trace_adjoint.h"

namespace neuvv::training {

constexpr float kTrainingStop = 1.0f / 256;  // the transmittance below which rays end

struct StepSettings {
    float frame = 0;
    uint32_t tiles = 0;
    LossWeights weights = kLossWeightsWithoutSmoothness;
    uint32_t samples = 1;  // rays a pixel, per side
    bool colours = false;  // the batch was loaded with colours of cameras; computes the derivatives by them
    float stop = render::kStopTransmittance;
    LearningRates rates;
    AdamSettings adam;
    bool learn_rows = false;

    // The share that one ray has in its pixel.
    float pixel_share() const { return 1.0f / static_cast<float>(samples * samples); }
};

struct StepResult {
    double rgb_loss = 0;   // mean over pixels of the squared error, summed over channels
    double grad_loss = 0;  // L_grad, mean over pixels
    uint64_t pixels = 0;
    uint32_t slots = 0;     // live leaves that have a slot
    uint32_t overflow = 0;  // live leaves for which there was no slot
    uint32_t touched = 0;   // slots that rays touched

    // The part of the loss that the device reports: the point loss and smoothness are missing.
    double total(const LossWeights& weights) const { return rgb_loss + static_cast<double>(weights.grad) * grad_loss; }
};

// Uploads the tree for training: weights in single precision. Where A and B may learn, all planes count as busy.
render::Field training_field(const gpu::Device& device, const voctree::VOctree& tree);

// Adds up what loss.comp wrote for each tile (LossBatch::sums). The counts of slots stay 0.
StepResult summed_losses(const glm::vec4* sums, uint32_t tiles);

// The buffers of a training run on the device: field, slice, rays, gradients, moments. For each step: fill rays() and
// batch() with tiles (load_batch() does so), call submit(), prepare the next tiles meanwhile, call wait(). The members
// of a team do so together, each with tiles of its own, all with the same tree and settings but for the number of
// tiles: wait() then moves the weights by the sum of all members' gradients.
class TrainingStep {
  public:
    // A step has at most `cameras` cameras and `tiles` tiles. Throws RuntimeFailure where the device's memory is too
    // small.
    TrainingStep(const gpu::Device& device, const voctree::VOctree& tree, uint32_t cameras, uint32_t tiles,
                 const Team& team = {});

    const render::RayBatch& rays() const { return rays_; }
    const LossBatch& batch() const { return batch_; }
    const render::Field& field() const { return field_; }
    const Moments& moments() const { return moments_; }

    void submit(const StepSettings& settings);
    // Losses and pixels are those of all members together.
    StepResult wait();
    // Per tile of the last step that had `colours`: the derivative of its loss by its camera's colour. After wait().
    const CameraColour* colour_gradients() const { return colours_readback_.as<CameraColour>(); }
    // Of the last step, after wait().
    const std::vector<gpu::PassTime>& pass_times() const { return pass_times_; }

    // Traces the first `tiles` tiles of rays() at a frame, forwards only. Returns by ray the premultiplied linear RGB
    // and alpha, valid until the next call. Not between submit() and wait().
    const glm::vec4* trace(float frame, uint32_t tiles, float stop);

    // Writes the current weights, A and B into `tree`, which must have the same topology (assert).
    void download(voctree::VOctree& tree) const;
    // How rays used the leaves since construction.
    const LeafTally& tally() const { return tally_; }

  private:
    // The step's first half, from weights to gradients, pass by pass. It slices only where slice_ is not that of the
    // frame already. The second half moves the weights.
    void record_gradients(const StepSettings& settings);
    void record_update(const StepSettings& settings);
    StepResult own_result() const;
    // Does the second half with the gradients of all members: each adds up those of its share of the leaves, and gives
    // the others the sums.
    StepResult update_together(const StepResult& own);

    const gpu::Device& device_;
    Team team_;
    render::Field field_;
    render::Slice slice_;
    render::RayBatch rays_;
    LossBatch batch_;
    SliceGradients gradients_;
    Moments moments_;
    LeafTally tally_;
    gpu::Buffer sums_readback_, colours_readback_, live_readback_, touched_readback_, radiance_readback_;
    render::Slicer slicer_;
    render::Tracer tracer_;
    Loss loss_;
    TraceAdjoint trace_adjoint_;
    TouchedList touched_list_;
    Smoother smoother_;
    SliceAdjoint slice_adjoint_;
    std::optional<GradientRecords> records_;  // of a member of a team
    RecordSum record_sum_;
    gpu::Commands commands_;
    StepSettings settings_;  // of the submitted step
    std::vector<gpu::PassTime> pass_times_;
    std::optional<float> sliced_frame_;  // the frame of slice_, if slice_ is that of the current weights
};

}  // namespace neuvv::training
