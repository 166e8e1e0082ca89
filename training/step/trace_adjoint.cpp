#include "training/step/trace_adjoint.h"

#include <algorithm>

#include "spirv/trace_adjoint.comp.h"
#include "spirv/trace_adjoint_cas.comp.h"
#include "training/step/array_buffers.h"

namespace neuvv::training {

namespace {

uint64_t gradient_bytes(uint32_t slots, uint32_t degree) {
    return uint64_t{4} * gradient_stride(degree) * slots;
}

}  // namespace

SliceGradients::SliceGradients(const gpu::Device& device, const render::Field& field, const render::Slice& slice)
    : gradients(device, "slice gradients", gradient_bytes(slice.capacity, field.hh_degree), gpu::MemoryKind::kDevice),
      max_weight(device, "slot max weight", uint64_t{4} * slice.capacity, gpu::MemoryKind::kDevice),
      touched(device, "touched slots", uint64_t{4} * slice.capacity, gpu::MemoryKind::kDevice, VK_FORMAT_R32_UINT),
      touched_count(device, "touched count", sizeof(LiveCount), gpu::MemoryKind::kDevice),
      partials(device, "row partials", uint64_t{8} * kMaxBases * gpu::groups_of(slice.capacity, kSliceGroup),
               gpu::MemoryKind::kDevice) {
    gpu::run_once(device, "clear gradients", [&](gpu::Commands& commands) {
        gpu::fill(commands, gradients, 0);
        gpu::fill(commands, max_weight, 0);
        gpu::compute_barrier(commands);
    });
}

uint32_t max_training_slots(const gpu::Device& device, uint32_t hh_degree) {
    const uint64_t bytes = std::min<uint64_t>(device.limits().maxStorageBufferRange, device.max_allocation_bytes());
    return static_cast<uint32_t>(bytes / gradient_bytes(1, hh_degree));
}

AtomicAdd best_atomic_add(const gpu::Device& device) {
    return device.float_atomics() ? AtomicAdd::kNative : AtomicAdd::kCompareAndSwap;
}

TraceAdjoint::TraceAdjoint(const gpu::Device& device, const render::Field& given_field, const render::Slice& slice,
                           const render::RayBatch& rays, const LossBatch& batch, const SliceGradients& gradients,
                           AtomicAdd atomics)
    : field(given_field),
      pass(device, "trace adjoint",
           atomics == AtomicAdd::kNative
               ? array_buffers(device).fitting(trace_adjoint_comp, trace_adjoint_comp_storage)
               : array_buffers(device).fitting(trace_adjoint_cas_comp, trace_adjoint_cas_comp_storage),
           {field.hh_degree, field.node_levels, field.top_levels}),
      set(pass, {{kTraceLinks, &field.links},
                 {kTraceNodes, &field.nodes},
                 {kTraceNodeLive, &slice.node_live},
                 {kTraceHead, &slice.head},
                 {kTraceSh, &slice.sh},
                 {kTraceCameras, &rays.cameras},
                 {kTraceTiles, &rays.tiles},
                 {kTraceRadiance, &rays.radiance},
                 {kTraceAdjoint, &batch.adjoint},
                 {kTraceTarget, &batch.target},
                 {kTraceGradients, &gradients.gradients},
                 {kTraceMaxWeight, &gradients.max_weight}}) {}

void record_trace_adjoint(gpu::Commands& commands, const TraceAdjoint& adjoint, uint32_t tiles, float stop,
                          const LossWeights& weights, float pixel_share) {
    const gpu::PassScope scope(commands, "trace adjoint");
    const TracePush trace = render::trace_push(adjoint.field, stop);
    gpu::dispatch_groups(
        commands, adjoint.pass, adjoint.set, tiles,
        TraceAdjointPush{trace.box_min, trace.box_size, trace.top, weights, pixel_share, trace.leaf_count});
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::training
