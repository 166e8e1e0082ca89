#include "render/volume/slices/slice.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"

#include "spirv/rows.comp.h"
#include "spirv/slice_colour.comp.h"
#include "spirv/slice_density.comp.h"

namespace neuvv::render {

LiveLeaves::LiveLeaves(const gpu::Device& device, const Field& field, uint32_t slots)
    : capacity(std::max(slots, 1u)),
      rows(device, "basis rows", sizeof(BasisRows), gpu::MemoryKind::kDevice),
      node_live(device, "live cells", field.live_bytes(), gpu::MemoryKind::kDevice, VK_FORMAT_R32G32_UINT),
      head(device, "slice head", uint64_t{8} * field.leaf_count, gpu::MemoryKind::kDevice, VK_FORMAT_R32G32_UINT),
      slot_leaf(device, "slice leaves", uint64_t{4} * capacity, gpu::MemoryKind::kDevice, VK_FORMAT_R32_UINT),
      live(device, "live count", sizeof(LiveCount), gpu::MemoryKind::kDevice) {
    // The limit of the indirect dispatches over slots.
    if (gpu::groups_of(capacity, kSliceGroup) > device.limits().maxComputeWorkGroupCount[0])
        throw RuntimeFailure(
            fmt::format("{} leaves that may live at once are more than this device dispatches", capacity),
            Remedy::kNoSlices);
}

Slice::Slice(const gpu::Device& device, const Field& field, uint32_t slots)
    : LiveLeaves(device, field, slots),
      sh(device, "slice SH", uint64_t{16} * sh_count(field.hh_degree) * capacity, gpu::MemoryKind::kDevice,
         VK_FORMAT_R32G32B32A32_SFLOAT) {}

LiveFinder::LiveFinder(const gpu::Device& device, const Field& given_field, const LiveLeaves& given_live)
    : field(given_field),
      live(given_live),
      rows(device, "rows", device.buffers().fitting(rows_comp, rows_comp_storage)),
      density(device, "slice density", device.buffers().fitting(slice_density_comp, slice_density_comp_storage),
              {field.hh_degree, field.basis_planes(), field.busy_planes, field.half_weights ? 1u : 0u,
               field.weights_by_address ? 1u : 0u}),
      rows_set(rows, {{kRowsSigmaBasis, &field.sigma_basis},
                      {kRowsGammaBasis, &field.gamma_basis},
                      {kRowsOut, &live.rows},
                      {kRowsLive, &live.live}}),
      density_set(density, {{kSliceWeights, &field.bound_weights()},
                            {kSliceRows, &live.rows},
                            {kSliceHead, &live.head},
                            {kSliceLeaves, &live.slot_leaf},
                            {kSliceLive, &live.live},
                            {kSliceLeafCells, &field.leaf_cells},
                            {kSliceNodeLive, &live.node_live}}) {}

void record_rows(gpu::Commands& commands, const LiveFinder& finder, float frame) {
    const Field& field = finder.field;
    RowsPush push{frame, field.frames, field.bases, field.part_planes_log2};
    if (field.weights_by_address)
        for (size_t i = 0; i < field.weights.size(); ++i) {
            const glm::uvec2 address = field.weights[i].address();
            glm::uvec4& pair = push.weights[i / 2];
            pair = i % 2 == 0 ? glm::uvec4(address, 0, 0) : glm::uvec4(pair.x, pair.y, address);
        }
    gpu::dispatch_groups(commands, finder.rows, finder.rows_set, 1, push);
    gpu::compute_barrier(commands);
}

void record_density(gpu::Commands& commands, const LiveFinder& finder, uint32_t first, uint32_t end) {
    const SlicePush push{finder.field.leaf_count, finder.live.capacity, first, end};
    gpu::dispatch(commands, finder.density, finder.density_set, gpu::groups_of(end - first, kLeavesPerThread), push);
    gpu::compute_barrier(commands);
}

Slicer::Slicer(const gpu::Device& device, const Field& given_field, const Slice& given_slice)
    : field(given_field),
      slice(given_slice),
      finder(device, field, slice),
      colour(device, "slice colour", device.buffers().fitting(slice_colour_comp, slice_colour_comp_storage),
             {field.hh_degree, field.basis_planes(), field.busy_planes, field.half_weights ? 1u : 0u,
              field.weights_by_address ? 1u : 0u}),
      colour_set(colour, {{kSliceWeights, &field.bound_weights()},
                          {kSliceRows, &slice.rows},
                          {kSliceLeaves, &slice.slot_leaf},
                          {kSliceLive, &slice.live},
                          {kSliceSh, &slice.sh}}) {}

void record_slice(gpu::Commands& commands, const Slicer& slicer, float frame) {
    const gpu::PassScope scope(commands, "slice");
    const Field& field = slicer.field;
    gpu::copy(commands, field.node_cells, slicer.slice.node_live, field.live_bytes());
    record_rows(commands, slicer.finder, frame);
    record_density(commands, slicer.finder, 0, field.leaf_count);
    gpu::dispatch_indirect(commands, slicer.colour, slicer.colour_set, slicer.slice.live, 0,
                           SlicePush{field.leaf_count, slicer.slice.capacity, 0, field.leaf_count});
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::render
