// What happens to the tree of a run where a phase begins (schedule.h): leaves merge, are removed, divide and revive;
// and to the finished clip where it is too large.
#pragma once

#include "training/data/dataset.h"
#include "training/run/checkpoint.h"

namespace neuvv::training {

struct TreeChange {
    RunState& run;  // in the phase that begins; max_depth may change
    const Dataset& dataset;
    double epochs = 0;            // of the phase before
    double looks = 0;             // the same times pixels_of_leaves() in that phase
    double rays_of_run = 0;       // that the whole run is expected to trace, at the speed so far
    uint32_t max_leaves = 0;      // the bound on leaves; 0: none
    double hull_margin = 0;       // TreeShape::hull_margin
    bool may_stay_coarse = true;  // TrainSettings::may_stay_coarse
};

// How many pixels of the nearest camera a leaf of this phase covers, of surroundings; else 1. So many times as many
// rays come through it in an epoch as through a leaf of a pixel.
double pixels_of_leaves(const RunState& run);

// Changes the tree. `use`: of its leaves, since it last changed.
void change_tree(const TreeChange& change, voctree::VOctree& tree, LeafUse use);

struct ClipSize {
    uint32_t leaves;
    uint64_t bytes;
};
// Writes the .nvv again without leaves of lowest maximum weight, until it has at most `max_bytes`; the tree keeps all
// leaves. `size`: of the .nvv so far. Returns how many leaves it then has.
uint32_t save_within_bytes(const std::filesystem::path& nvv, uint64_t max_bytes, const Dataset& dataset,
                           const voctree::VOctree& tree, const LeafUse& use, ClipSize size);

}  // namespace neuvv::training
