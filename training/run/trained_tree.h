// The tree of a run: on the host, where its topology changes, and on the device, where its weights move.
#pragma once

#include <memory>

#include "training/step/step.h"

namespace neuvv::training {

// Owns both forms. From make_step() until `tree` changes its leaves they are the same tree, but the host has the
// weights of the last step->download(tree).
struct TrainedTree {
    voctree::VOctree tree;
    std::unique_ptr<TrainingStep> step;
    uint32_t finest = 0;  // octree depth of the finest leaves
};

// Replaces the step by one for the tree of now. `cameras`: of the data set; `tiles`: RunState::tiles_per_step.
void make_step(const gpu::Device& device, TrainedTree& trained, size_t cameras, uint32_t tiles, const Team& team);

// How many leaves the device can train as live leaves at once, in trees with the bases and the degree of this one, and
// for how many there is room in `memory_bytes`, which were free when the run began.
uint32_t trainable_leaves(const gpu::Device& device, const voctree::VOctree& tree, uint64_t memory_bytes);

}  // namespace neuvv::training
