// Makes the first tree of a training run by training the network Ψ (errata 18).
#pragma once

#include <functional>

#include "training/psi/psi.h"
#include "training/tree/first_tree.h"

namespace neuvv::training {

struct PsiSettings {
    double minutes = 0;  // budget in wall time, or
    uint64_t steps = 0;  // in steps
    uint64_t seed = 1;
    uint32_t frequencies = 8, width = 64, layers = 4;
    PsiSampling sampling;
    uint32_t tiles_per_step = 128;
    float threshold = 1e-5f;         // 1/m: a cell is empty if its σ, summed over the frames, is below
    uint32_t points_per_leaf = 256;  // random points whose mean a leaf gets
};

// The paper does not say how large the network is. On a GPU these settings are moderate; a CPU device gets half the
// width, fewer samples and smaller steps, as it would finish too few larger steps.
PsiSettings default_psi_settings(const gpu::Device& device);

struct PsiProgress {
    double elapsed_s = 0, eta_s = 0;
    double rays_per_s = 0;
    double loss = 0, psnr = 0;  // of the batches since the last report, as in TrainProgress
    uint64_t step = 0;
    std::vector<gpu::PassTime> passes;  // of the last step
};
// Called about once a second, and once at the end; returns false to end the training of Ψ.
using PsiCallback = std::function<bool(const PsiProgress&)>;

// Trains Ψ within hull_box(dataset) until its budget is spent, then makes a tree of it. Of the leaves of
// initial_tree(dataset, shape, levels_above), those stay in which the centre of at least one finest cell reaches the
// threshold. A leaf's weights are the mean of Ψ over random points in the leaf; A and B are those of Ψ. Throws what
// initial_tree throws, and RuntimeFailure where training diverges or no leaf stays.
voctree::VOctree psi_tree(const gpu::Device& device, const Dataset& dataset, const TreeShape& shape,
                          uint32_t levels_above, const PsiSettings& settings, const PsiCallback& callback);

// The second half of psi_tree alone: makes a tree of `psi`. The leaves, the box and the shape are those of `hull`.
voctree::VOctree tree_from_psi(PsiStep& psi, const voctree::VOctree& hull, uint32_t levels_above,
                               const PsiSettings& settings);

}  // namespace neuvv::training
