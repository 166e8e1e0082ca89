#include "training/step/direct_adjoint.h"

#include "spirv/direct_adjoint.comp.h"
#include "spirv/direct_adjoint_cas.comp.h"
#include "training/step/array_buffers.h"

namespace neuvv::training {

DirectAdjoint::DirectAdjoint(const gpu::Device& device, const render::Field& given_field,
                             const render::LiveLeaves& live, const render::RayBatch& rays, const LossBatch& batch,
                             const gpu::Buffer& gradients, AtomicAdd atomics)
    : field(given_field),
      pass(device, "direct adjoint",
           atomics == AtomicAdd::kNative
               ? array_buffers(device).fitting(direct_adjoint_comp, direct_adjoint_comp_storage)
               : array_buffers(device).fitting(direct_adjoint_cas_comp, direct_adjoint_cas_comp_storage),
           {field.hh_degree, field.node_levels, field.top_levels, field.basis_planes(), field.busy_planes}),
      set(pass, {{kTraceLinks, &field.links},
                 {kTraceNodes, &field.nodes},
                 {kTraceWeights, &field.whole_weights()},
                 {kTraceRows, &live.rows},
                 {kTraceCameras, &rays.cameras},
                 {kTraceTiles, &rays.tiles},
                 {kTraceRadiance, &rays.radiance},
                 {kTraceAdjoint, &batch.adjoint},
                 {kTraceTarget, &batch.target},
                 {kTraceGradients, &gradients}}) {}

void record_direct_adjoint(gpu::Commands& commands, const DirectAdjoint& adjoint, uint32_t tiles, float stop,
                           const LossWeights& weights, float pixel_share) {
    const gpu::PassScope scope(commands, "direct adjoint");
    const TracePush trace = render::trace_push(adjoint.field, stop);
    gpu::dispatch_groups(
        commands, adjoint.pass, adjoint.set, tiles,
        TraceAdjointPush{trace.box_min, trace.box_size, trace.top, weights, pixel_share, trace.leaf_count});
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::training
