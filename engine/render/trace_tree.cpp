#include "render/trace_tree.h"

#include "spirv/trace_tree.comp.h"

namespace neuvv {

TreeTracer::TreeTracer(const Device& device, const Field& field, const SliceTrees& trees, const Buffer& entries,
                       const TileRanges& ranges, const RayBatch& rays, Shading shading, const WalkSteps& steps)
    : field_(field),
      trees_(trees),
      ranges_(ranges),
      pass_(device, "trace tree", trace_tree_comp,
            {field.hh_degree, field.node_levels, field.top_levels, shading == Shading::kPerLeaf ? 1u : 0u,
             steps.restart ? 1u : 0u, steps.from_root ? 1u : 0u, steps.coalesce ? 1u : 0u}),
      set_(pass_, {{kTraceTop, &field.top},
                   {kTraceNodes, &trees.nodes},
                   {kTraceEntries, &entries},
                   {kTraceCameras, &rays.cameras},
                   {kTraceTiles, &rays.tiles},
                   {kTraceTileList, &ranges.list},
                   {kTraceTileRanges, &ranges.ranges},
                   {kTraceRadiance, &rays.radiance},
                   {kTraceDepth, &rays.depth}}) {}

void record_clear(Commands& commands, const RayBatch& rays, uint32_t tiles) {
    const PassScope scope(commands, "clear");
    constexpr uint32_t kInfinity = 0x7f800000;
    fill(commands, rays.radiance, 0, uint64_t{16} * kTilePixels * tiles);
    fill(commands, rays.depth, kInfinity, uint64_t{4} * kTilePixels * tiles);
    compute_barrier(commands);
}

void record_trace_tree(Commands& commands, const TreeTracer& tracer, uint32_t slice, uint32_t first_camera,
                       float stop) {
    const PassScope scope(commands, "trace");
    TracePush push = trace_push(tracer.field_, stop);
    push.shaded_stride = tracer.trees_.capacity;
    push.first_camera = first_camera;
    push.node_base = tracer.trees_.node_base(slice);
    push.entry_base = tracer.trees_.entry_base(slice);
    dispatch_indirect(commands, tracer.pass_, tracer.set_, tracer.ranges_.count, 0, push);
    compute_barrier(commands);
}

}  // namespace neuvv
