#include "render/volume/trace_tree.h"

#include <cassert>

#include "spirv/trace_tree.comp.h"

namespace neuvv::render {

TreeTracer::TreeTracer(const gpu::Device& device, const Field& given_field, const SliceTrees& given_trees,
                       const gpu::Buffer& entries, const RayTarget& given_target, Shading shading, RayOutput output,
                       const Intervals* intervals)
    : field(given_field),
      trees(given_trees),
      target(given_target),
      pass(device, "trace tree", device.buffers().fitting(trace_tree_comp, trace_tree_comp_storage),
           {field.hh_degree, field.node_levels, field.top_levels, shading == Shading::kPerLeaf ? 1u : 0u,
            static_cast<uint32_t>(output), shading == Shading::kNone ? 1u : 0u, field.has_srgb_colours ? 1u : 0u}),
      set(pass, gpu::joined({{kTraceNodes, &trees.nodes}, {kTraceEntries, &entries}},
                            instance_bindings(field, target, output, intervals))) {}

TracePush tree_push(const Field& field, const SliceTrees& trees, uint32_t slice, const InstanceRays& rays) {
    TracePush push = instance_push(field, rays);
    push.shaded_stride = trees.capacity;
    push.node_base = trees.node_base(slice);
    push.entry_base = trees.entry_base(slice);
    return push;
}

void record_trace_tree(gpu::Commands& commands, const TreeTracer& tracer, uint32_t slice, const InstanceRays& rays) {
    const gpu::PassScope scope(commands, "trace");
    const TracePush push = tree_push(tracer.field, tracer.trees, slice, rays);
    gpu::dispatch_indirect(commands, tracer.pass, tracer.set, tracer.target.ranges.count, 0, push);
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::render
