// A training run on disk: the .nvv that anybody can open, and beside it the .nvv.state from which the run can go on.
#pragma once

#include <filesystem>

#include "training/rig/rig_changes.h"
#include "training/run/schedule.h"
#include "training/step/camera_colour.h"
#include "training/step/step.h"
#include "voctree/files/world_frame.h"

namespace neuvv::training {

// Who says what a run learns of cameras' colours.
enum class ColourChoice : uint32_t {
    kGiven,   // its settings
    kOpen,    // all of its settings are tried, until the run chooses
    kChosen,  // the run chose what is worth it
};

// How far a run has come and with which settings it began: everything but the tree and Adam's moments.
struct RunState {
    uint64_t seed = 1;
    uint64_t step = 0;
    uint32_t adam_step = 0;  // steps since the moments were 0
    uint32_t phase = 0;
    uint64_t phase_rays = 0;    // rays since the phase began, counted as pixels
    uint64_t dataset_hash = 0;  // shows whether a resumed run has the same data set
    uint32_t max_depth = 0;  // octree depth of leaves of a pixel's size; less where leaves stay larger (kMinRaysOfLeaf)
    // Of surroundings (surroundings_tree.h): the resolution, and how large the finest leaves look; 0: of a performer.
    uint32_t leaves_along_image = 0;
    double leaf_pixels = 0;
    bool resolution_is_natural = false;       // no user chose it
    uint64_t several_rays_from = UINT64_MAX;  // the first step with several rays per pixel
    uint32_t max_leaves = 0;                  // the run's bounds; 0: none
    uint64_t max_bytes = 0;
    bool adaptive = true;
    ColourChoice colour_choice = ColourChoice::kGiven;
    OptionalParts left_out = 0;
    double elapsed_s = 0;
    double other_s = 0;  // of elapsed_s: what was no step, but checkpoints, changes of the tree and reports
    double rays = 0;
    double squared_error = 0;  // of a colour channel, a running mean; 0 before the first step
    double minutes = 0;        // the run's budget in minutes or in steps; one of the two is 0
    uint64_t steps = 0;
    uint32_t tiles_per_step = 512;
    LossWeights weights = kLossWeightsWithoutSmoothness;
    std::string program;  // name and version of the program that began the run
};

// What a checkpoint file holds: everything that a run needs to go on. The .nvv beside it may be older or newer.
struct Checkpoint {
    RunState run;
    voctree::VOctree tree;                       // fp32 weights
    std::vector<uint16_t> first, second;         // moments of the weights, bfloat16, in planes
    std::vector<float> rows_first, rows_second;  // moments of A, then those of B
    LeafUse use;
    CameraColours colours;        // empty where the run does not refine them
    RigChanges rig;               // empty where the run did not correct the rig
    voctree::WorldFrame frame{};  // of the data set, which the .nvv remembers
};

std::filesystem::path state_path(const std::filesystem::path& nvv);

// Downloads weights, bases, moments and use of the leaves. `tree` has the run's topology.
Checkpoint take_checkpoint(const TrainingStep& step, const voctree::VOctree& tree, const RunState& run,
                           const CameraColours& colours = {}, const RigChanges& rig = {});

// Replaces the checkpoint file, then the .nvv, each atomically: at any moment each file is the old or the new one, and
// wherever there is a .nvv, its run can be resumed. As a clip, the checkpoint file would show nothing: its weights are
// in a chunk of their own. A tree with a number that is not finite is not written. Returns how many leaves the .nvv
// has. Throws RuntimeFailure.
uint32_t save_checkpoint(const std::filesystem::path& nvv, Checkpoint checkpoint);

// Writes the .nvv alone, made compact (compact.h). Returns how many leaves it has. Throws RuntimeFailure.
uint32_t save_compact(const std::filesystem::path& nvv, voctree::VOctree tree, const voctree::WorldFrame& frame = {});

// Throws InputError where the checkpoint file is missing, damaged or not of a training run.
Checkpoint load_checkpoint(const std::filesystem::path& nvv);

// Uploads the moments and the use of the leaves. The step must have been made from checkpoint.tree.
void restore_moments(const gpu::Device& device, const TrainingStep& step, const Checkpoint& checkpoint);

}  // namespace neuvv::training
