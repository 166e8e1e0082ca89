// Lists the slots that the rays of a step touched. The passes after it run over those alone.
#pragma once

#include "render/volume/slices/slice.h"
#include "training/step/trace_adjoint.h"

namespace neuvv::training {

struct TouchedList {
    TouchedList(const gpu::Device& device, const render::Slice& slice, const SliceGradients& gradients);

    const render::Slice& slice;
    const SliceGradients& gradients;
    gpu::ComputePass pass;
    gpu::BindingSet set;
};

// Records after record_trace_adjoint. Fills SliceGradients::touched and touched_count.
void record_touched(gpu::Commands& commands, const TouchedList& list);

}  // namespace neuvv::training
