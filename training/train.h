// A training run: data set in, .nvv out.
#pragma once

#include <filesystem>
#include <functional>

#include "training/checkpoint.h"
#include "training/grow.h"

namespace neuvv::training {

struct TrainSettings {
    double minutes = 0;  // budget in wall time, or
    uint64_t steps = 0;  // in steps; both 0: kDefaultMinutes, or what a resumed run had
    TreeShape shape;
    uint64_t seed = 1;
    uint32_t max_leaves = 0;  // that the tree may have (0: as many as the device trains)
    uint64_t max_bytes = 0;   // that the .nvv may have in the end (0: any)
    bool adaptive = true;     // false: every leaf of the finest uniform level stays, none becomes finer
    uint32_t tiles_per_step = 512;
    LossWeights weights = kDefaultLossWeights;
    std::string program = "NeuVV";  // for the record
    bool resume = false;
    const voctree::VOctree* first_tree = nullptr;  // what a run begins with in place of initial_tree: leaves all
                                                   // kLevelsAbove above the finest depth of `shape`
};

constexpr double kDefaultMinutes = 20;

struct TrainProgress {
    double elapsed_s = 0, eta_s = 0;
    double fraction = 0;  // of the budget
    double rays_per_s = 0;
    double loss = 0, psnr = 0;  // of the last second's batches; PSNR of their tiles, most with foreground, over their
                                // backgrounds; loss without the point loss
    double rgb_loss = 0, grad_loss = 0;  // the loss's terms, before their weights
    uint64_t step = 0;
    uint64_t began_at_step = 0;  // 0, or the step that --resume went on from
    uint32_t leaves = 0, depth = 0;
    double epochs = 0;
    std::vector<gpu::PassTime> passes;     // of the last step
    const render::Field* field = nullptr;  // the model as it is now; idle and alive while the callback runs, not longer
};

// Called about once a second, and once at the end; false stops the run after a checkpoint.
using TrainCallback = std::function<bool(const TrainProgress&)>;

// Trains until the budget is spent and leaves the last checkpoint at `output`. The first is written before the first
// step, later ones so that they take at most a twentieth of the time. Throws InputError (a data set without matter, a
// state file that does not fit) and RuntimeFailure.
TrainProgress train(const gpu::Device& device, const Dataset& dataset, const TrainSettings& settings,
                    const std::filesystem::path& output, const TrainCallback& callback);

}  // namespace neuvv::training
