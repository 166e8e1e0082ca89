#include "training/trace_adjoint.h"

#include <algorithm>

#include "spirv/trace_adjoint.comp.h"
#include "spirv/trace_adjoint_cas.comp.h"

namespace neuvv {

namespace {

uint64_t gradient_bytes(uint32_t slots, uint32_t degree) {
    return uint64_t{4} * gradient_stride(degree) * slots;
}

}  // namespace

SliceGradients::SliceGradients(const Device& device, const Field& field, const Slice& slice)
    : gradients(device, "slice gradients", gradient_bytes(slice.capacity, field.hh_degree), MemoryKind::kDevice),
      reach(device, "slot reach", uint64_t{4} * slice.capacity, MemoryKind::kDevice),
      touched(device, "touched slots", uint64_t{4} * slice.capacity, MemoryKind::kDevice, VK_FORMAT_R32_UINT),
      touched_count(device, "touched count", sizeof(LiveCount), MemoryKind::kDevice),
      partials(device, "row partials", uint64_t{8} * kMaxBases * ((slice.capacity + kSliceGroup - 1) / kSliceGroup),
               MemoryKind::kDevice) {
    run_once(device, "clear gradients", [&](Commands& commands) {
        fill(commands, gradients, 0);
        fill(commands, reach, 0);
        compute_barrier(commands);
    });
}

uint32_t max_training_slots(const Device& device, uint32_t hh_degree) {
    const uint64_t bytes = std::min<uint64_t>(device.limits().maxStorageBufferRange, device.max_allocation_bytes());
    return static_cast<uint32_t>(bytes / gradient_bytes(1, hh_degree));
}

AtomicAdd best_atomic_add(const Device& device) {
    return device.float_atomics() ? AtomicAdd::kNative : AtomicAdd::kCompareAndSwap;
}

TraceAdjoint::TraceAdjoint(const Device& device, const Field& field, const Slice& slice, const RayBatch& rays,
                           const LossBatch& batch, const SliceGradients& gradients, AtomicAdd atomics)
    : field_(field),
      pass_(device, "trace adjoint",
            atomics == AtomicAdd::kNative ? std::span<const uint32_t>(trace_adjoint_comp)
                                          : std::span<const uint32_t>(trace_adjoint_cas_comp),
            {field.hh_degree, field.node_levels, field.top_levels}),
      set_(pass_, {{kTraceTop, &field.top},
                   {kTraceNodes, &field.nodes},
                   {kTraceChildren, &field.children},
                   {kTraceNodeLive, &slice.node_live},
                   {kTraceHead, &slice.head},
                   {kTraceSh, &slice.sh},
                   {kTraceCameras, &rays.cameras},
                   {kTraceTiles, &rays.tiles},
                   {kTraceRadiance, &rays.radiance},
                   {kTraceAdjoint, &batch.adjoint},
                   {kTraceTarget, &batch.target},
                   {kTraceGradients, &gradients.gradients},
                   {kTraceReach, &gradients.reach}}) {}

void record_trace_adjoint(Commands& commands, const TraceAdjoint& adjoint, uint32_t tiles, float stop,
                          float lambda_point) {
    const PassScope scope(commands, "trace adjoint");
    const TracePush trace = trace_push(adjoint.field_, stop);
    dispatch(commands, adjoint.pass_, adjoint.set_, tiles,
             TraceAdjointPush{trace.box_min, trace.box_size, trace.top, lambda_point, trace.leaf_count});
    compute_barrier(commands);
}

}  // namespace neuvv
