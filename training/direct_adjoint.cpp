#include "training/direct_adjoint.h"

#include "spirv/direct_adjoint.comp.h"
#include "spirv/direct_adjoint_cas.comp.h"

namespace neuvv {

DirectAdjoint::DirectAdjoint(const Device& device, const Field& field, const LiveLeaves& live, const RayBatch& rays,
                             const LossBatch& batch, const Buffer& gradients, AtomicAdd atomics)
    : field_(field),
      pass_(device, "direct adjoint",
            atomics == AtomicAdd::kNative ? std::span<const uint32_t>(direct_adjoint_comp)
                                          : std::span<const uint32_t>(direct_adjoint_cas_comp),
            {field.hh_degree, field.node_levels, field.top_levels, field.basis_planes(), field.busy_planes}),
      set_(pass_, {{kTraceTop, &field.top},
                   {kTraceNodes, &field.nodes},
                   {kTraceChildren, &field.children},
                   {kTraceWeights, &field.weights},
                   {kTraceRows, &live.rows},
                   {kTraceCameras, &rays.cameras},
                   {kTraceTiles, &rays.tiles},
                   {kTraceRadiance, &rays.radiance},
                   {kTraceAdjoint, &batch.adjoint},
                   {kTraceTarget, &batch.target},
                   {kTraceGradients, &gradients}}) {}

void record_direct_adjoint(Commands& commands, const DirectAdjoint& adjoint, uint32_t tiles, float stop,
                           float lambda_point) {
    const PassScope scope(commands, "direct adjoint");
    const TracePush trace = trace_push(adjoint.field_, stop);
    dispatch(commands, adjoint.pass_, adjoint.set_, tiles,
             TraceAdjointPush{trace.box_min, trace.box_size, trace.top, lambda_point, trace.leaf_count});
    compute_barrier(commands);
}

}  // namespace neuvv
