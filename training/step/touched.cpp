#include "training/step/touched.h"

#include "spirv/touched.comp.h"
#include "training/step/array_buffers.h"

namespace neuvv::training {

TouchedList::TouchedList(const gpu::Device& device, const render::Slice& given_slice,
                         const SliceGradients& given_gradients)
    : slice(given_slice),
      gradients(given_gradients),
      pass(device, "touched", array_buffers(device).fitting(touched_comp, touched_comp_storage)),
      set(pass, {{kTouchedMaxWeight, &gradients.max_weight},
                 {kTouchedLive, &slice.live},
                 {kTouchedSlots, &gradients.touched},
                 {kTouchedCount, &gradients.touched_count}}) {}

void record_touched(gpu::Commands& commands, const TouchedList& list) {
    const gpu::PassScope scope(commands, "touched");
    gpu::update(commands, list.gradients.touched_count, LiveCount{0, 1, 1, 0, 0});
    gpu::compute_barrier(commands);
    gpu::dispatch_indirect(commands, list.pass, list.set, list.slice.live, 0, nullptr, 0);
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::training
