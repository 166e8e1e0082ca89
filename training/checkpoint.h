// A training run on disk: the .nvv that anybody can open, and beside it the .nvv.state that --resume goes on from.
#pragma once

#include <filesystem>

#include "training/step.h"

namespace neuvv::training {

// Where a run stands, apart from tree and moments.
struct RunState {
    uint64_t seed = 1;
    uint64_t step = 0;
    uint32_t adam_step = 0;  // since the moments were 0
    uint32_t phase = 0;
    uint64_t phase_rays = 0;                  // traced since the phase began
    uint64_t dataset_hash = 0;                // tells the data set from others
    uint32_t max_depth = 0;                   // octree depth of leaves of a pixel's size
    uint64_t several_rays_from = UINT64_MAX;  // the first step that took several rays a pixel
    uint32_t max_leaves = 0;                  // the run's bounds; 0: none
    uint64_t max_bytes = 0;
    bool adaptive = true;
    double elapsed_s = 0;
    double rays = 0;
    double minutes = 0;  // the run's budget; one of the two is 0
    uint64_t steps = 0;
    uint32_t tiles_per_step = 512;
    LossWeights weights{0.1f, 0.2f, 0};
    std::string program;  // that began the run, and its version
};

// What a state file holds: everything, so that it does not matter whether the .nvv beside it is a step older or newer.
struct Checkpoint {
    RunState run;
    voctree::VOctree tree;                       // fp32 weights
    std::vector<uint16_t> first, second;         // moments, bfloat16, in planes
    std::vector<float> rows_first, rows_second;  // moments of A, then B
    LeafUse use;
};

std::filesystem::path state_path(const std::filesystem::path& nvv);

// Takes weights, rows and moments off the device. `tree` has the run's topology.
Checkpoint take_checkpoint(const TrainingStep& step, const voctree::VOctree& tree, const RunState& run);

// Replaces the state, then the .nvv: each is at any moment the old or the new one, and where there is a .nvv, a run can
// be resumed. Returns how many leaves the .nvv has. Throws RuntimeFailure.
uint32_t save_checkpoint(const std::filesystem::path& nvv, const Checkpoint& checkpoint);

// Writes the .nvv alone, made compact. Returns how many leaves it has.
uint32_t save_compact(const std::filesystem::path& nvv, voctree::VOctree tree);

// Throws InputError where the state file is missing, damaged or not of a training run.
Checkpoint load_checkpoint(const std::filesystem::path& nvv);

// Puts the moments back; the step was made from checkpoint.tree.
void restore_moments(const gpu::Device& device, const TrainingStep& step, const Checkpoint& checkpoint);

}  // namespace neuvv::training
