// Which slots the rays of a step reached: the passes after it run over those alone.
#pragma once

#include "render/slice.h"
#include "training/trace_adjoint.h"

namespace neuvv {

class TouchedList {
  public:
    TouchedList(const Device& device, const Slice& slice, const SliceGradients& gradients);

  private:
    friend void record_touched(Commands&, const TouchedList&);
    const Slice& slice_;
    const SliceGradients& gradients_;
    ComputePass pass_;
    BindingSet set_;
};

// After record_trace_adjoint. Fills SliceGradients::touched and touched_count.
void record_touched(Commands& commands, const TouchedList& list);

}  // namespace neuvv
