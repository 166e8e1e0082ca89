#include "training/step/smooth.h"

#include "spirv/smooth.comp.h"
#include "training/step/array_buffers.h"

namespace neuvv::training {

Smoother::Smoother(const gpu::Device& device, const render::Field& given_field, const render::Slice& slice,
                   const SliceGradients& given_gradients)
    : field(given_field),
      gradients(given_gradients),
      pass(device, "smooth", array_buffers(device).fitting(smooth_comp, smooth_comp_storage),
           {field.hh_degree, field.node_levels, field.top_levels}),
      set(pass, {{kTraceLinks, &field.links},
                 {kTraceNodes, &field.nodes},
                 {kTraceNodeLive, &slice.node_live},
                 {kTraceHead, &slice.head},
                 {kTraceSh, &slice.sh},
                 {kSmoothLeaves, &slice.slot_leaf},
                 {kSmoothPositions, &field.leaf_positions},
                 {kSmoothTouched, &gradients.touched},
                 {kSmoothCount, &gradients.touched_count},
                 {kSmoothGradients, &gradients.gradients}}) {}

void record_smooth(gpu::Commands& commands, const Smoother& smoother, const LossWeights& weights, float pixel_share) {
    const gpu::PassScope scope(commands, "smooth");
    gpu::dispatch_indirect(commands, smoother.pass, smoother.set, smoother.gradients.touched_count, 0,
                           SmoothPush{smoother.field.top_box, smoother.field.box_size.x, weights, pixel_share});
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::training
