// Slice, backwards, and the optimiser: moves the weights of leaves that rays reached, and the rows of A and B.
#pragma once

#include "render/slice.h"
#include "shared/training.h"
#include "training/trace_adjoint.h"

namespace neuvv::training {

// Adam's moments, laid out as what they belong to. Starts at 0.
struct Moments {
    Moments(const gpu::Device& device, const render::Field& field);

    gpu::Buffer first, second;            // of the weights, in planes
    gpu::Buffer rows_first, rows_second;  // of A, then of B
};

// What rays said of each leaf since the tree last changed: what growth goes by.
struct LeafUse {
    std::vector<float> max_weight;           // largest blending weight
    std::vector<float> opacity_sensitivity;  // Σ |α ∂L/∂α| of its samples
    std::vector<uint32_t> frames;  // per 32 frames and leaf, leaves fastest: a bit for each frame that used it
};

// The same on the device. Starts at 0.
struct LeafTally {
    LeafTally(const gpu::Device& device, const voctree::VOctree& tree);

    gpu::Buffer use;     // (reach, pull)
    gpu::Buffer frames;  // bits
};

LeafUse read_use(const gpu::Device& device, const LeafTally& tally, const voctree::VOctree& tree);
void write_use(const gpu::Device& device, const LeafTally& tally, const LeafUse& use);

struct LearningRates {
    float sigma = 0;                       // of w^σ, optical depths of the leaf's edge
    float gamma = 0;                       // of w^γ
    float colour = 0;                      // of w^HH with l = 0
    float detail = 0;                      // of w^HH with l > 0
    float sigma_rows = 0, gamma_rows = 0;  // of A and B
};

struct AdamSettings {
    float beta1 = 0.9f, beta2 = 0.99f, epsilon = 1e-8f;
    uint32_t step = 1;          // since the moments were 0
    bool emit_only = false;     // no move; the first moments receive the gradient (tests)
    float min_used_weight = 0;  // blending weight from which a frame counts as using a leaf
};

struct SliceAdjoint {
    SliceAdjoint(const gpu::Device& device, const render::Field& field, const render::Slice& slice,
                 const SliceGradients& gradients, const Moments& moments, const LeafTally& tally);

    const render::Field& field;
    const SliceGradients& gradients;
    gpu::ComputePass leaves, leaves_and_rows, rows;
    gpu::BindingSet leaves_set, leaves_and_rows_set, rows_set;
};

// After record_touched. `frame` is that of the slice. Rows move too where `learn_rows`; where they do not, the slice is
// still that of the field afterwards.
void record_slice_adjoint(gpu::Commands& commands, const SliceAdjoint& adjoint, float frame, const LearningRates& rates,
                          const AdamSettings& adam, bool learn_rows);

}  // namespace neuvv::training
