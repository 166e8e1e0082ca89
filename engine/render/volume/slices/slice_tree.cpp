#include "render/volume/slices/slice_tree.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "base/error.h"

#include "spirv/slice_entries.comp.h"
#include "spirv/slice_nodes.comp.h"

namespace neuvv::render {

uint32_t max_entries(const Field& field) {
    return field.leaf_count + field.node_count() - 1;
}

uint64_t slice_bytes(const Field& field, uint32_t entries) {
    const uint64_t entry = 4 * kEntryWords * sh_count(field.hh_degree) + 4;
    return entry * entries + field.nodes.bytes + sizeof(LiveCount);
}

void expect_dispatch(const gpu::Device& device, uint32_t entries, Remedy remedy) {
    if (gpu::groups_of(entries, kSliceGroup) > device.limits().maxComputeWorkGroupCount[0])
        throw RuntimeFailure(
            fmt::format("{} live leaves and nodes at once are more than this device dispatches", entries), remedy);
}

SliceTrees::SliceTrees(SliceBuffers built, uint32_t nodes_of_slice, uint32_t entries_of_slice)
    : SliceBuffers(std::move(built)), capacity(std::max(entries_of_slice, 1u)), slices(1), node_count(nodes_of_slice) {}

SliceTrees::SliceTrees(const gpu::Device& device, const Field& field, uint32_t entry_capacity, uint32_t slice_count,
                       TreesBegin begin)
    : capacity(std::max(entry_capacity, 1u)), slices(slice_count), node_count(field.node_count()) {
    const auto buffer = [&](const char* name, uint64_t bytes, VkFormat format = VK_FORMAT_UNDEFINED) {
        return gpu::Buffer(device, name, bytes * slices, gpu::MemoryKind::kDevice, format);
    };
    nodes = buffer("slice nodes", field.nodes.bytes, VK_FORMAT_R32G32B32A32_UINT);
    entries = buffer("slice entries", uint64_t{4} * kEntryWords * sh_count(field.hh_degree) * capacity,
                     VK_FORMAT_R32G32_UINT);
    entry_leaf = buffer("leaves of entries", uint64_t{4} * capacity, VK_FORMAT_R32_UINT);
    counts = buffer("counts of entries", sizeof(LiveCount));
    expect_dispatch(device, capacity, Remedy::kNoSlices);
    if (begin == TreesBegin::kEmpty)
        gpu::run_once(device, "empty trees", [this](gpu::Commands& commands) { record_empty(commands, *this); });
}

void record_empty(gpu::Commands& commands, const SliceTrees& trees) {
    gpu::fill(commands, trees.counts, 0);
    // Entries of a node that is left out for lack of room are never written.
    gpu::fill(commands, trees.entry_leaf, kNoLeaf);
    gpu::compute_barrier(commands);
}

TreeSlicer::TreeSlicer(const gpu::Device& device, const Field& given_field, const LiveLeaves& given_live,
                       const SliceTrees& given_trees)
    : field(given_field),
      live(given_live),
      trees(given_trees),
      finder(device, field, live),
      nodes(device, "slice nodes", device.buffers().fitting(slice_nodes_comp, slice_nodes_comp_storage),
            {field.hh_degree}),
      entries(device, "slice entries", device.buffers().fitting(slice_entries_comp, slice_entries_comp_storage),
              {field.hh_degree, field.basis_planes(), field.busy_planes, field.half_weights ? 1u : 0u,
               field.weights_by_address ? 1u : 0u}),
      nodes_set(nodes, {{kNodesTree, &field.nodes},
                        {kNodesLinks, &field.links},
                        {kNodesCells, &field.node_cells},
                        {kNodesLive, &live.node_live},
                        {kNodesOut, &trees.nodes},
                        {kNodesEntries, &trees.entries},
                        {kNodesLeaves, &trees.entry_leaf},
                        {kNodesCount, &trees.counts}}),
      entries_set(entries, {{kSliceWeights, &field.bound_weights()},
                            {kSliceRows, &live.rows},
                            {kSliceHead, &live.head},
                            {kSliceLeaves, &live.slot_leaf},
                            {kSliceLive, &live.live},
                            {kEntriesCells, &field.leaf_cells},
                            {kEntriesNodes, &trees.nodes},
                            {kEntriesOut, &trees.entries},
                            {kEntriesLeaves, &trees.entry_leaf}}) {}

namespace {

void record_nodes(gpu::Commands& commands, const TreeSlicer& slicer, uint32_t slice) {
    const gpu::PassScope scope(commands, "slice nodes");
    const SliceTrees& trees = slicer.trees;
    const std::vector<uint32_t>& begin = slicer.field.level_begin;
    for (size_t level = begin.size() - 1; level-- > 0;) {
        const SliceNodesPush push{begin[level],   begin[level + 1] - begin[level], slice,
                                  trees.capacity, trees.node_base(slice),          slicer.field.node_count()};
        gpu::dispatch(commands, slicer.nodes, slicer.nodes_set, push.nodes, push);
        gpu::compute_barrier(commands);
    }
}

void record_slice_begin(gpu::Commands& commands, const TreeSlicer& slicer, uint32_t slice, float frame) {
    gpu::fill(commands, slicer.live.node_live, 0);
    // The overflow is not cleared: trees that have any are replaced (Performer::enlarge_slices).
    const LiveCount none{0, 1, 1, 0, 0};
    gpu::update(commands, slicer.trees.counts, &none, offsetof(LiveCount, overflow), slice * sizeof(LiveCount));
    record_rows(commands, slicer.finder, frame);
}

void record_entries(gpu::Commands& commands, const TreeSlicer& slicer, uint32_t slice) {
    const gpu::PassScope scope(commands, "slice entries");
    gpu::dispatch_indirect(
        commands, slicer.entries, slicer.entries_set, slicer.live.live, 0,
        SliceEntriesPush{slicer.field.leaf_count, slicer.live.capacity, slicer.trees.node_base(slice), 0});
    gpu::compute_barrier(commands);
}

}  // namespace

void record_slice_tree(gpu::Commands& commands, const TreeSlicer& slicer, uint32_t slice, float frame,
                       const SlicePaint* paint) {
    {
        const gpu::PassScope scope(commands, "slice density");
        record_slice_begin(commands, slicer, slice, frame);
        record_density(commands, slicer.finder, 0, slicer.field.leaf_count);
    }
    if (paint) record_paint_density(commands, *paint, frame);
    record_nodes(commands, slicer, slice);
    record_entries(commands, slicer, slice);
    if (paint) record_paint_colour(commands, *paint, slice, frame);
}

void record_slice_part(gpu::Commands& commands, const TreeSlicer& slicer, uint32_t slice, float frame, uint32_t part,
                       const SlicePaint* paint) {
    constexpr uint32_t kDensityParts = 3, kEntryParts = kSliceParts - kDensityParts - 1;
    const uint32_t leaves = slicer.field.leaf_count, slots = slicer.trees.capacity;
    if (part < kDensityParts) {
        const gpu::PassScope scope(commands, "slice density");
        if (part == 0) record_slice_begin(commands, slicer, slice, frame);
        const auto share = [leaves](uint64_t i) { return static_cast<uint32_t>(leaves * i / kDensityParts); };
        record_density(commands, slicer.finder, share(part), share(part + 1));
    } else if (part == kDensityParts) {
        if (paint) record_paint_density(commands, *paint, frame);
        record_nodes(commands, slicer, slice);
    } else {
        const auto share = [slots](uint64_t i) { return static_cast<uint32_t>(slots * i / kEntryParts); };
        const uint32_t first = share(part - kDensityParts - 1);
        // Leaves that paint has erased still have slots, so slots of other leaves may lie beyond the number of entries.
        const bool last = part + 1 == kSliceParts;
        const uint32_t end = last && paint ? slicer.live.capacity : share(part - kDensityParts);
        {
            const gpu::PassScope scope(commands, "slice entries");
            gpu::dispatch(
                commands, slicer.entries, slicer.entries_set, end - first,
                SliceEntriesPush{leaves, std::min(end, slicer.live.capacity), slicer.trees.node_base(slice), first});
            gpu::compute_barrier(commands);
        }
        if (last && paint) record_paint_colour(commands, *paint, slice, frame);
    }
}

}  // namespace neuvv::render
