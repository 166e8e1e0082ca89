// A training run: data set in, .nvv out.
#pragma once

#include <filesystem>
#include <functional>

#include "training/rig/rig_changes.h"
#include "training/run/checkpoint.h"
#include "training/step/team.h"
#include "training/tree/first_tree.h"

namespace neuvv::training {

class BatchSampler;

// A run between two of its steps.
struct BetweenSteps {
    TrainingStep& step;
    const BatchSampler& sampler;
    double fraction;  // of the budget
    uint32_t phase;   // index into phases_of()
    const CameraColours& colours;
};

struct TrainSettings {
    // The budget, in wall time or in steps; where both are given, the run ends when one is spent. Where both are 0 it
    // is kDefaultMinutes, or what a resumed run had.
    double minutes = 0;
    uint64_t steps = 0;
    TreeShape shape;
    uint64_t seed = 1;
    uint32_t max_leaves = 0;     // bound on the leaves of the tree (0: as many as the device can train)
    uint64_t max_bytes = 0;      // bound on the size of the finished .nvv (0: none)
    bool adaptive = true;        // false: all leaves end at the depth of `shape`; none is removed or becomes finer
    OptionalParts left_out = 0;  // schedule.h
    // Whether leaves may stay larger than a pixel where rays are few (schedule.h, kMinRaysOfLeaf).
    bool may_stay_coarse = true;
    uint32_t tiles_per_step = 512;  // of each member of the team
    LossWeights weights = kDefaultLossWeights;
    ColourRefinement refine;  // what is learnt of how cameras show colours; a resumed run does what it did
    // Whether `refine` is only tried at first: from kChoosesColoursAt on, the run learns what of it is worth it
    // (colour_findings.h).
    bool try_colours = false;
    // Corrections of the rig that search_rig() found, kept in checkpoint files; a resumed run has its own.
    RigChanges rig;
    std::string program = "NeuVV";  // RunState::program
    bool resume = false;
    // Whether the data set is of what stands around the performer (read_surroundings). The run then begins with
    // surroundings_tree, and `shape.resolution` counts leaves along the longer side of an image.
    bool surroundings = false;
    // The tree with which a run begins, in place of initial_tree. All its leaves must lie kLevelsAbovePixel levels
    // above the finest depth of `shape`.
    const voctree::VOctree* first_tree = nullptr;
    // Called between steps; returns false to end the run. It may move the data set's cameras, and may use the step as
    // long as it changes no weights.
    std::function<bool(const BetweenSteps&)> between_steps;
    // Processes that train this tree together, all with the same data set and settings. Cameras are refined by one
    // process alone: in a larger team, `refine`, `rig` and `between_steps` must be empty (InputError; assert).
    Team team;
};

constexpr double kDefaultMinutes = 20;

// How many tiles of 8×8 rays a step should have on a device. An H100 runs eight times as many threads at once as 512
// tiles have rays, and its passes take 1.2 ms for 2048 tiles, 0.9 ms for 512; but too large a batch leaves a short run
// too few steps (RESULTS.md, "On a GPU"), so the `members` of a team share the tiles of one GPU, down to 512 each.
uint32_t default_tiles_per_step(const gpu::Device& device, uint32_t members = 1);

struct TrainProgress {
    double elapsed_s = 0, eta_s = 0;
    double other_s = 0;   // of elapsed_s, what was no step: loading, changes of the tree, checkpoints, callbacks
    double fraction = 0;  // of the budget
    double rays_per_s = 0;
    // Of the batches since the last report. The loss is StepResult::total; the PSNR (dB) is that of their pixels, most
    // of which lie in tiles with foreground.
    double loss = 0, psnr = 0;
    double rgb_loss = 0, grad_loss = 0;  // the terms of the loss, before their weights
    uint64_t step = 0;
    uint64_t began_at_step = 0;  // 0, or the step from which the run went on
    uint32_t leaves = 0, depth = 0;
    double epochs = 0;
    std::vector<gpu::PassTime> passes;  // of the last step
    CameraColours colours;              // empty where they are not refined
    ColourChoice colour_choice = ColourChoice::kGiven;
    std::vector<RefinedPose> poses;        // by camera, where they were refined
    std::vector<double> frames_late;       // the same
    std::vector<double> readout;           // the same
    bool leaves_stay_large = false;        // the last division of all leaves was left out: rays were few for them
    const render::Field* field = nullptr;  // the current model; the callback may use it until it returns
};

// Called about once a second, and once at the end; returns false to stop the run after a checkpoint.
using TrainCallback = std::function<bool(const TrainProgress&)>;

// Trains until the budget is spent. The first checkpoint is written to `output` before the first step, later ones so
// that they take at most a twentieth of the time, the last one at the end; where `output` is empty, none is. The run
// applies the corrections of the rig to the data set, which stays so. Of a team, the first member alone writes files,
// its clock is that of the run, and a callback of any member can stop all. Throws InputError (for instance
// for a data set without matter, or a checkpoint file of another data set) and RuntimeFailure.
TrainProgress train(const gpu::Device& device, Dataset& dataset, const TrainSettings& settings,
                    const std::filesystem::path& output, const TrainCallback& callback);

}  // namespace neuvv::training
