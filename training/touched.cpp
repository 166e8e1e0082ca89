#include "training/touched.h"

#include "spirv/touched.comp.h"

namespace neuvv::training {

TouchedList::TouchedList(const gpu::Device& device, const render::Slice& slice, const SliceGradients& gradients)
    : slice_(slice),
      gradients_(gradients),
      pass_(device, "touched", touched_comp),
      set_(pass_, {{kTouchedReach, &gradients.reach},
                   {kTouchedLive, &slice.live},
                   {kTouchedSlots, &gradients.touched},
                   {kTouchedCount, &gradients.touched_count}}) {}

void record_touched(gpu::Commands& commands, const TouchedList& list) {
    const gpu::PassScope scope(commands, "touched");
    gpu::update(commands, list.gradients_.touched_count, LiveCount{0, 1, 1, 0, 0});
    gpu::compute_barrier(commands);
    gpu::dispatch_indirect(commands, list.pass_, list.set_, list.slice_.live, 0, nullptr, 0);
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::training
