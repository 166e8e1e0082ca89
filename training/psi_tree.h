// A run's first tree by way of the network Ψ (errata 18).
#pragma once

#include <functional>

#include "training/grow.h"
#include "training/psi.h"

namespace neuvv::training {

struct PsiSettings {
    double minutes = 0;  // budget in wall time, or
    uint64_t steps = 0;  // in steps
    uint64_t seed = 1;
    uint32_t frequencies = 8, width = 64, layers = 4;
    PsiSampling sampling;
    uint32_t tiles_per_step = 128;
    float threshold = 1e-5f;         // 1/m: a cell whose σ, summed over the frames, stays below it is empty
    uint32_t points_per_leaf = 256;  // whose mean a leaf gets
};

// The paper does not give the network's size. On a GPU this is a moderate one; a CPU device gets half its width, fewer
// samples and smaller steps, or it would see too few of them.
PsiSettings default_psi_settings(const gpu::Device& device);

struct PsiProgress {
    double elapsed_s = 0, eta_s = 0;
    double rays_per_s = 0;
    double loss = 0, psnr = 0;  // of the last second's batches, as TrainProgress has them
    uint64_t step = 0;
    std::vector<gpu::PassTime> passes;  // of the last step
};
// Called about once a second, and once at the end; false ends the training of Ψ.
using PsiCallback = std::function<bool(const PsiProgress&)>;

// Trains Ψ within hull_box(dataset) until its budget is spent, then reads a tree off it: of the cells of
// initial_tree(dataset, shape, levels_above) those stay of which any finest cell's centre passes the threshold; a
// leaf's weights are the mean over random points in it. A and B are those of Ψ. Throws as initial_tree does, and
// RuntimeFailure where training diverges or no cell passes.
voctree::VOctree psi_tree(const gpu::Device& device, const Dataset& dataset, const TreeShape& shape,
                          uint32_t levels_above, const PsiSettings& settings, const PsiCallback& callback);

// The second half alone: the tree that `psi` stands for; `hull` gives the cells, box and shape.
voctree::VOctree tree_from_psi(PsiStep& psi, const voctree::VOctree& hull, uint32_t levels_above,
                               const PsiSettings& settings);

}  // namespace neuvv::training
