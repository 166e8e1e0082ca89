#include "render/volume/trace.h"

#include <cassert>

#include "render/volume/intervals.h"

#include "spirv/direct.comp.h"
#include "spirv/trace.comp.h"

namespace neuvv::render {

TracePush trace_push(const Field& field, float stop) {
    TracePush push{};
    push.box_min = glm::vec4(field.box_min, stop);
    push.box_size = glm::vec4(field.box_size, 1);
    push.top = field.top_box;
    push.leaf_count = field.leaf_count;
    push.end_tile = UINT32_MAX;
    push.levels_above = field.levels_above;
    push.density = 1;
    return push;
}

TracePush instance_push(const Field& field, const InstanceRays& rays) {
    TracePush push = trace_push(field, rays.stop);
    push.box_size.w = rays.opacity;
    push.density = rays.density;
    push.first_camera = rays.first_camera;
    push.first_tile = rays.tiles.first;
    push.end_tile = rays.tiles.end;
    push.set_width = rays.set_size.x;
    push.set_texels = rays.set_size.x * rays.set_size.y;
    push.lighting = rays.lighting;
    return push;
}

gpu::Bindings trace_bindings(const Field& field, const RayBatch& rays) {
    return {{kTraceLinks, &field.links}, {kTraceNodes, &field.nodes},      {kTraceCameras, &rays.cameras},
            {kTraceTiles, &rays.tiles},  {kTraceRadiance, &rays.radiance}, {kTraceDepth, &rays.depth}};
}

// Bindings of buffers that do not exist get other buffers of the same formats, which are not read.
gpu::Bindings instance_bindings(const Field& field, const RayTarget& target, RayOutput output,
                                const Intervals* intervals) {
    assert(output != RayOutput::kIntervals || intervals);
    const bool bound = output == RayOutput::kIntervals;
    return gpu::joined(trace_bindings(field, target.rays),
                       {{kTraceTileList, &target.ranges.list},
                        {kTraceTileRanges, &target.ranges.ranges},
                        {kTraceSharing, &target.ranges.sharing},
                        {kTracePages, bound ? &intervals->pages() : &target.no_lights},
                        {kTraceSetDepth, target.set_buffers.set_depth},
                        {kTraceLights, target.set_buffers.lights},
                        {kTraceSetShadows, target.set_buffers.set_shadows},
                        {kTracePerformerShadows, target.set_buffers.performer_shadows}});
}

Tracer::Tracer(const gpu::Device& device, const Field& given_field, const Slice& slice, const RayBatch& rays)
    : field(given_field),
      pass(device, "trace", device.buffers().fitting(trace_comp, trace_comp_storage),
           {field.hh_degree, field.node_levels, field.top_levels, field.has_srgb_colours ? 1u : 0u}),
      set(pass, gpu::joined(trace_bindings(field, rays),
                            {{kTraceNodeLive, &slice.node_live}, {kTraceHead, &slice.head}, {kTraceSh, &slice.sh}})) {}

void record_trace(gpu::Commands& commands, const Tracer& tracer, uint32_t tiles, float stop) {
    const gpu::PassScope scope(commands, "trace");
    gpu::dispatch_groups(commands, tracer.pass, tracer.set, tiles, trace_push(tracer.field, stop));
    gpu::compute_barrier(commands);
}

// Bindings that only instances need get other buffers of the same formats, which are not read.
DirectTracer::DirectTracer(const gpu::Device& device, const Field& given_field, const LiveLeaves& live,
                           const RayBatch& rays, Walk walk)
    : field(given_field),
      no_lights(device, "no lights", sizeof(ShaderLights), gpu::MemoryKind::kDevice),
      pass(device, walk == Walk::kFromRoot ? "paper" : "direct",
           device.buffers().fitting(direct_comp, direct_comp_storage),
           {field.hh_degree, field.node_levels, field.top_levels, field.basis_planes(),
            walk == Walk::kFromRoot ? field.basis_planes() : field.busy_planes, walk == Walk::kFromRoot ? 1u : 0u,
            kOutputRay, field.half_weights ? 1u : 0u, field.has_srgb_colours ? 1u : 0u,
            field.weights_by_address ? 1u : 0u}),
      set(pass, gpu::joined(trace_bindings(field, rays), {{kTraceWeights, &field.bound_weights()},
                                                          {kTraceRows, &live.rows},
                                                          {kTraceTileList, &rays.tiles},
                                                          {kTraceTileRanges, &rays.tiles},
                                                          {kTraceSharing, &rays.tiles},
                                                          {kTracePages, &no_lights},
                                                          {kTraceSetDepth, &rays.depth},
                                                          {kTraceLights, &no_lights},
                                                          {kTraceSetShadows, &rays.depth},
                                                          {kTracePerformerShadows, &rays.cameras}})) {}

DirectTracer::DirectTracer(const gpu::Device& device, const Field& given_field, const LiveLeaves& live,
                           const RayTarget& target, RayOutput output, const Intervals* intervals)
    : field(given_field),
      tile_count(&target.ranges.count),
      pass(device, "direct", device.buffers().fitting(direct_comp, direct_comp_storage),
           {field.hh_degree, field.node_levels, field.top_levels, field.basis_planes(), field.busy_planes, 0,
            static_cast<uint32_t>(output), field.half_weights ? 1u : 0u, field.has_srgb_colours ? 1u : 0u,
            field.weights_by_address ? 1u : 0u}),
      set(pass, gpu::joined({{kTraceWeights, &field.bound_weights()}, {kTraceRows, &live.rows}},
                            instance_bindings(field, target, output, intervals))) {}

void record_direct(gpu::Commands& commands, const DirectTracer& tracer, uint32_t tiles, float stop) {
    const gpu::PassScope scope(commands, tracer.pass.name());
    gpu::dispatch_groups(commands, tracer.pass, tracer.set, tiles, trace_push(tracer.field, stop));
    gpu::compute_barrier(commands);
}

void record_direct_instance(gpu::Commands& commands, const DirectTracer& tracer, const InstanceRays& rays) {
    const gpu::PassScope scope(commands, tracer.pass.name());
    gpu::dispatch_indirect(commands, tracer.pass, tracer.set, *tracer.tile_count, 0, instance_push(tracer.field, rays));
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::render
