// Slice, backwards, and the optimiser: moves the weights of leaves that rays reached, and the rows of A and B.
#pragma once

#include "render/slice.h"
#include "shared/training.h"
#include "training/trace_adjoint.h"

namespace neuvv {

// Adam's moments, laid out as what they belong to. Starts at 0.
struct Moments {
    Moments(const Device& device, const Field& field);

    Buffer first, second;            // of the weights, in planes
    Buffer rows_first, rows_second;  // of A, then of B
};

struct LearningRates {
    float sigma = 0;                       // of w^σ, 1/m
    float gamma = 0;                       // of w^γ
    float colour = 0;                      // of w^HH with l = 0
    float detail = 0;                      // of w^HH with l > 0
    float sigma_rows = 0, gamma_rows = 0;  // of A and B
};

struct AdamSettings {
    float beta1 = 0.9f, beta2 = 0.99f, epsilon = 1e-8f;
    uint32_t step = 1;       // since the moments were 0
    bool emit_only = false;  // no move; the first moments receive the gradient (tests)
};

class SliceAdjoint {
  public:
    SliceAdjoint(const Device& device, const Field& field, const Slice& slice, const SliceGradients& gradients,
                 const Moments& moments);

  private:
    friend void record_slice_adjoint(Commands&, const SliceAdjoint&, float, const LearningRates&, const AdamSettings&,
                                     bool);
    const Field& field_;
    const Slice& slice_;
    const SliceGradients& gradients_;
    ComputePass touched_, leaves_, leaves_and_rows_, rows_;
    BindingSet touched_set_, leaves_set_, leaves_and_rows_set_, rows_set_;
};

// `frame` is that of the slice. Rows move too where `learn_rows`.
void record_slice_adjoint(Commands& commands, const SliceAdjoint& adjoint, float frame, const LearningRates& rates,
                          const AdamSettings& adam, bool learn_rows);

}  // namespace neuvv
