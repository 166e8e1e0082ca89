#include "voctree/stream_slice.h"

#include <array>
#include <cassert>

#include "base/threads/parallel.h"
#include "voctree/frame_leaves.h"
#include "voctree/sh_weights.h"
#include "voctree/slice_values.h"
#include "voctree/temporal_basis.h"

namespace neuvv::voctree {

namespace {

constexpr size_t kLeavesOfPart = 4096;

}  // namespace

stream::Slice slice_of(const VOctree& tree, double frame, std::span<const PaintStep> paint) {
    for ([[maybe_unused]] const PaintStep& step : paint) assert(step.layer->field.leaf_count == tree.leaf_count);
    const RowsAtTime rows(tree, frame);
    const FrameEdits edits(paint, static_cast<float>(frame));
    const std::vector<LiveLeaf> live = live_leaves(tree, rows, edits, 0.5f / stream::kUnit);
    stream::Slice slice{2 * tree.node_levels, tree.hh_degree, {}, {}};
    slice.planes.resize(stream::planes_of(slice.degree));
    for (auto& plane : slice.planes) plane.resize(live.size());
    slice.leaves.resize(live.size());
    parallel_for(live.size(), kLeavesOfPart, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            slice.leaves[i] = {live[i].cell, live[i].depth};
            slice.planes[stream::kOpacityPlane][i] = units_of(live[i].opacity);
            set_colours(leaf_colours(tree, live[i].leaf, rows, edits), i, slice);
        }
    });
    return slice;
}

VOctree tree_of(const stream::Slice& slice, glm::vec3 box_min, glm::vec3 box_size, float fps) {
    assert(slice.depth % 2 == 0);
    VOctree tree;
    tree.box_min = box_min;
    tree.box_size = box_size;
    tree.node_levels = slice.depth / 2;
    tree.fps = fps;
    make_still(tree, slice.degree);
    build_topology(tree, leaf_positions(slice));
    std::array<float, stream::kMaxDepth + 1> edges;
    for (uint32_t d = 0; d < edges.size(); ++d) edges[d] = leaf_edge_m(tree, d);
    parallel_for(slice.leaves.size(), kLeavesOfPart, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            float* weights = tree.leaf(static_cast<uint32_t>(i));
            weights[0] = optical_depth_of(slice.planes[stream::kOpacityPlane][i]) / edges[slice.leaves[i].depth];
            const LeafColours k = colours_of(slice, i);
            for (uint32_t c = 0; c < 3; ++c)
                write_sh(weights + 2 + c * hh_count(slice.degree), slice.degree, k[c].data());
        }
    });
    return tree;
}

}  // namespace neuvv::voctree
