#include "render/slice.h"

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
      node_live(device, "live cells", field.inner_cells.bytes, gpu::MemoryKind::kDevice, VK_FORMAT_R32G32_UINT),
      head(device, "slice head", uint64_t{8} * field.leaf_count, gpu::MemoryKind::kDevice, VK_FORMAT_R32G32_UINT),
      slot_leaf(device, "slice leaves", uint64_t{4} * capacity, gpu::MemoryKind::kDevice, VK_FORMAT_R32_UINT),
      live(device, "live count", sizeof(LiveCount), gpu::MemoryKind::kDevice) {
    const uint32_t groups = (capacity + kSliceGroup - 1) / kSliceGroup;  // of the indirect dispatches
    if (groups > device.limits().maxComputeWorkGroupCount[0])
        throw RuntimeFailure(
            fmt::format("{} leaves that may live at once are more than this device dispatches; it may "
                        "show the scene without slices (--slice-budget 0)",
                        capacity));
}

Slice::Slice(const gpu::Device& device, const Field& field, uint32_t slots)
    : LiveLeaves(device, field, slots),
      sh(device, "slice SH", uint64_t{16} * sh_count(field.hh_degree) * capacity, gpu::MemoryKind::kDevice,
         VK_FORMAT_R32G32B32A32_SFLOAT) {}

LiveFinder::LiveFinder(const gpu::Device& device, const Field& field, const LiveLeaves& live)
    : field_(field),
      live_(live),
      rows_(device, "rows", rows_comp),
      density_(device, "slice density", slice_density_comp, {field.hh_degree, field.basis_planes(), field.busy_planes}),
      rows_set_(rows_, {{kRowsSigmaBasis, &field.sigma_basis},
                        {kRowsGammaBasis, &field.gamma_basis},
                        {kRowsOut, &live.rows},
                        {kRowsLive, &live.live}}),
      density_set_(density_, {{kSliceWeights, &field.weights},
                              {kSliceRows, &live.rows},
                              {kSliceHead, &live.head},
                              {kSliceLeaves, &live.slot_leaf},
                              {kSliceLive, &live.live},
                              {kSliceLeafCells, &field.leaf_cells},
                              {kSliceNodeLive, &live.node_live}}) {}

void record_rows(gpu::Commands& commands, const LiveFinder& finder, float frame) {
    const Field& field = finder.field_;
    gpu::dispatch(commands, finder.rows_, finder.rows_set_, 1, RowsPush{frame, field.frames, field.bases});
    gpu::compute_barrier(commands);
}

void record_density(gpu::Commands& commands, const LiveFinder& finder, uint32_t first, uint32_t end) {
    constexpr uint32_t kGroupLeaves = kSliceGroup * kLeavesPerThread;
    const SlicePush push{finder.field_.leaf_count, finder.live_.capacity, first, end};
    gpu::dispatch(commands, finder.density_, finder.density_set_, (end - first + kGroupLeaves - 1) / kGroupLeaves,
                  push);
    gpu::compute_barrier(commands);
}

Slicer::Slicer(const gpu::Device& device, const Field& field, const Slice& slice)
    : field_(field),
      slice_(slice),
      finder_(device, field, slice),
      colour_(device, "slice colour", slice_colour_comp, {field.hh_degree, field.basis_planes(), field.busy_planes}),
      colour_set_(colour_, {{kSliceWeights, &field.weights},
                            {kSliceRows, &slice.rows},
                            {kSliceLeaves, &slice.slot_leaf},
                            {kSliceLive, &slice.live},
                            {kSliceSh, &slice.sh}}) {}

void record_slice(gpu::Commands& commands, const Slicer& slicer, float frame) {
    const gpu::PassScope scope(commands, "slice");
    const Field& field = slicer.field_;
    gpu::copy(commands, field.inner_cells, slicer.slice_.node_live, field.inner_cells.bytes);
    record_rows(commands, slicer.finder_, frame);
    record_density(commands, slicer.finder_, 0, field.leaf_count);
    gpu::dispatch_indirect(commands, slicer.colour_, slicer.colour_set_, slicer.slice_.live, 0,
                           SlicePush{field.leaf_count, slicer.slice_.capacity, 0, field.leaf_count});
    gpu::compute_barrier(commands);
}

}  // namespace neuvv::render
