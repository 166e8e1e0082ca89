// The adjoint of slice, and the optimiser: it moves the weights of leaves that rays touched, and the rows of A and B.
#pragma once

#include "render/volume/slices/slice.h"
#include "shared/training.h"
#include "training/step/trace_adjoint.h"
#include "training/tree/leaf_use.h"

namespace neuvv::training {

// Adam's moments, laid out as the numbers to which they belong. They start at 0.
struct Moments {
    Moments(const gpu::Device& device, const render::Field& field);

    gpu::Buffer first, second;            // moments of the weights, in planes
    gpu::Buffer rows_first, rows_second;  // moments of A, then those of B
};

// LeafUse on the device. It starts at 0.
struct LeafTally {
    LeafTally(const gpu::Device& device, const voctree::VOctree& tree);

    gpu::Buffer use;     // per leaf (max_weight, opacity_sensitivity)
    gpu::Buffer frames;  // as LeafUse::frames
};

// Download and upload of a tally; `tree` and `use` are those of the tally's tree.
LeafUse read_use(const gpu::Device& device, const LeafTally& tally, const voctree::VOctree& tree);
void write_use(const gpu::Device& device, const LeafTally& tally, const LeafUse& use);

// How far Adam moves a weight in one step.
struct LearningRates {
    float sigma = 0;                       // of w^σ, in optical depths over the leaf's edge
    float gamma = 0;                       // of w^γ
    float colour = 0;                      // of w^HH with l = 0
    float detail = 0;                      // of w^HH with l > 0
    float sigma_rows = 0, gamma_rows = 0;  // of A and B
};

struct AdamSettings {
    float beta1 = 0.9f, beta2 = 0.99f, epsilon = 1e-8f;
    uint32_t step = 1;          // steps since the moments were 0, this one included
    bool emit_only = false;     // nothing moves, and the first moments receive the gradient (for tests)
    float least_depth = 0;      // w^σ of the frame stays at least this optical depth over the leaf's edge; 0: no bound
    float min_used_weight = 0;  // a frame uses a leaf if it gives it at least this blending weight
};

struct SliceAdjoint {
    SliceAdjoint(const gpu::Device& device, const render::Field& field, const render::Slice& slice,
                 const SliceGradients& gradients, const Moments& moments, const LeafTally& tally);

    const render::Field& field;
    const SliceGradients& gradients;
    gpu::ComputePass leaves, leaves_and_rows, rows;
    gpu::BindingSet leaves_set, leaves_and_rows_set, rows_set;
};

// Records after record_touched. `frame` is that of the slice. AdamSettings::least_depth must be 0 unless each frame has
// its own basis and `frame` is one of them. With `learn_rows` the rows move, too; without, the slice
// is that of the moved weights afterwards.
void record_slice_adjoint(gpu::Commands& commands, const SliceAdjoint& adjoint, float frame, const LearningRates& rates,
                          const AdamSettings& adam, bool learn_rows);

}  // namespace neuvv::training
