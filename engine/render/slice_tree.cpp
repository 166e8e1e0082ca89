#include "render/slice_tree.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/error.h"

#include "spirv/slice_entries.comp.h"
#include "spirv/slice_nodes.comp.h"

namespace neuvv {

uint32_t most_entries(const Field& field) {
    return field.leaf_count + field.node_count() - 1;
}

SliceTree::SliceTree(const Device& device, const Field& field, uint32_t entry_capacity)
    : capacity(std::max(entry_capacity, 1u)),
      nodes(device, "slice nodes", field.nodes.bytes, MemoryKind::kDevice, VK_FORMAT_R32G32B32A32_UINT),
      entries(device, "slice entries", uint64_t{4} * kEntryWords * sh_count(field.hh_degree) * capacity,
              MemoryKind::kDevice, VK_FORMAT_R32G32_UINT),
      entry_leaf(device, "leaves of entries", uint64_t{4} * capacity, MemoryKind::kDevice, VK_FORMAT_R32_UINT),
      count(device, "count of entries", sizeof(LiveCount), MemoryKind::kDevice) {
    if ((capacity + kSliceGroup - 1) / kSliceGroup > device.limits().maxComputeWorkGroupCount[0])
        throw RuntimeFailure(fmt::format("{} live leaves at once are more than this device can dispatch", capacity));
}

TreeSlicer::TreeSlicer(const Device& device, const Field& field, const LiveLeaves& live, const SliceTree& tree)
    : field_(field),
      live_(live),
      tree_(tree),
      finder_(device, field, live),
      nodes_(device, "slice nodes", slice_nodes_comp, {field.hh_degree}),
      entries_(device, "slice entries", slice_entries_comp, {field.hh_degree, field.basis_planes(), field.busy_planes}),
      nodes_set_(nodes_, {{kNodesTree, &field.nodes},
                          {kNodesChildren, &field.children},
                          {kNodesInner, &field.inner_cells},
                          {kNodesParent, &field.node_cells},
                          {kNodesLive, &live.node_live},
                          {kNodesOut, &tree.nodes},
                          {kNodesEntries, &tree.entries},
                          {kNodesLeaves, &tree.entry_leaf},
                          {kNodesCount, &tree.count}}),
      entries_set_(entries_, {{kSliceWeights, &field.weights},
                              {kSliceRows, &live.rows},
                              {kSliceHead, &live.head},
                              {kSliceLeaves, &live.slot_leaf},
                              {kSliceLive, &live.live},
                              {kEntriesCells, &field.leaf_cells},
                              {kEntriesNodes, &tree.nodes},
                              {kEntriesOut, &tree.entries},
                              {kEntriesLeaves, &tree.entry_leaf}}) {}

void record_slice_tree(Commands& commands, const TreeSlicer& slicer, float frame) {
    const PassScope scope(commands, "slice");
    fill(commands, slicer.live_.node_live, 0);
    update(commands, slicer.tree_.count, LiveCount{0, 1, 1, 0, 0});
    record_live(commands, slicer.finder_, frame);
    const std::vector<uint32_t>& begin = slicer.field_.level_begin;
    for (size_t level = begin.size() - 1; level-- > 0;) {
        const SliceNodesPush push{begin[level], begin[level + 1] - begin[level], slicer.tree_.capacity};
        dispatch(commands, slicer.nodes_, slicer.nodes_set_, (push.nodes + kSliceGroup - 1) / kSliceGroup, push);
        compute_barrier(commands);
    }
    dispatch_indirect(commands, slicer.entries_, slicer.entries_set_, slicer.live_.live, 0,
                      SlicePush{slicer.field_.leaf_count, slicer.live_.capacity});
    compute_barrier(commands);
}

}  // namespace neuvv
