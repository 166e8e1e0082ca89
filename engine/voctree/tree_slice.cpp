#include "voctree/tree_slice.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

#include "base/sigmoid.h"
#include "base/threads/parallel.h"
#include "voctree/sh_weights.h"
#include "voctree/temporal_basis.h"

namespace neuvv::voctree {

namespace {

constexpr size_t kTreeLeavesOfPart = 4096;

struct LiveLeaf {
    uint64_t cell = 0;  // as slice::Leaf has it
    uint32_t depth = 0;
    uint32_t leaf = 0;  // index into the tree
    float sigma = 0;    // 1/m
    float opacity = 0;  // along the mean of its edges
};

// The leaves of at least slice::kLeastOpacity, in order of their cells. `edits`: those of the rows' time.
std::vector<LiveLeaf> live_leaves(const VOctree& tree, const RowsAtTime& rows, const FrameEdits& edits) {
    const std::vector<LeafPosition> positions = leaf_positions(tree);
    std::vector<LiveLeaf> leaves(tree.leaf_count);
    parallel_for(leaves.size(), kTreeLeavesOfPart, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            const auto leaf = static_cast<uint32_t>(i);
            const float unpainted = std::max(row_product(rows.sigma.data(), tree.leaf(leaf), tree.bases), 0.0f);
            const float sigma = edits.painted_density(leaf, unpainted);
            const float opacity = sigma > 0 ? 1 - std::exp(-sigma * leaf_edge_m(tree, positions[i].depth)) : 0;
            leaves[i] = {first_cell(positions[i], 2 * tree.node_levels), positions[i].depth, leaf, sigma, opacity};
        }
    });
    std::erase_if(leaves, [](const LiveLeaf& leaf) { return leaf.opacity < slice::kLeastOpacity; });
    std::sort(leaves.begin(), leaves.end(), [](const LiveLeaf& a, const LiveLeaf& b) { return a.cell < b.cell; });
    return leaves;
}

slice::Colours leaf_colours(const VOctree& tree, uint32_t leaf, const RowsAtTime& rows, const FrameEdits& edits) {
    const float* weights = tree.leaf(leaf) + tree.bases;
    const float angle = row_product(rows.gamma.data(), weights, tree.bases);
    const Radial radial = radial_functions(std::numbers::pi * double{sigmoid(angle)});
    weights += tree.bases;
    slice::Colours k{};
    for (auto& channel : k)
        for (uint32_t n = 0; n <= tree.hh_degree; ++n)
            for (uint32_t l = 0; l <= n; ++l)
                for (uint32_t i = 0; i <= 2 * l; ++i) channel[l * l + i] += radial[n][l] * *weights++;
    edits.paint_colours(leaf, tree.hh_degree, k);
    return k;
}

}  // namespace

slice::Slice slice_of(const VOctree& tree, double frame, std::span<const PaintStep> paint) {
    for ([[maybe_unused]] const PaintStep& step : paint) assert(step.layer->field.leaf_count == tree.leaf_count);
    const RowsAtTime rows(tree, frame);
    const FrameEdits edits(paint, static_cast<float>(frame));
    const std::vector<LiveLeaf> live = live_leaves(tree, rows, edits);
    slice::Slice slice{tree.box_min, tree.box_size, 2 * tree.node_levels, tree.hh_degree, {}};
    slice.leaves.resize(live.size());
    parallel_for(live.size(), kTreeLeavesOfPart, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            slice.leaves[i] = {live[i].cell, live[i].depth, live[i].sigma,
                               leaf_colours(tree, live[i].leaf, rows, edits), 0};
            slice.leaves[i].shown = slice.shown_alone(slice.leaves[i]);
        }
    });
    return slice;
}

VOctree tree_of(const slice::Slice& slice, float fps) {
    assert(slice.depth % 2 == 0);
    VOctree tree;
    tree.box_min = slice.box_min;
    tree.box_size = slice.box_size;
    tree.node_levels = slice.depth / 2;
    tree.fps = fps;
    make_still(tree, slice.degree);
    std::vector<LeafPosition> positions(slice.leaves.size());
    for (size_t i = 0; i < positions.size(); ++i) {
        const slice::Leaf& leaf = slice.leaves[i];
        positions[i] = position_of(leaf.cell >> 3 * (slice.depth - leaf.depth), leaf.depth);
    }
    build_topology(tree, positions);
    parallel_for(slice.leaves.size(), kTreeLeavesOfPart, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
            float* weights = tree.leaf(static_cast<uint32_t>(i));
            weights[0] = slice.leaves[i].sigma;
            for (uint32_t c = 0; c < 3; ++c)
                write_sh(weights + 2 + c * hh_count(slice.degree), slice.degree, slice.leaves[i].colours[c].data());
        }
    });
    return tree;
}

std::vector<LeafPosition> leaf_positions(const stream::QuantisedSlice& slice) {
    std::vector<LeafPosition> positions;
    positions.reserve(slice.leaves.size());
    for (const stream::Leaf& leaf : slice.leaves)
        positions.push_back(position_of(leaf.cell >> 3 * (slice.depth - leaf.depth), leaf.depth));
    return positions;
}

}  // namespace neuvv::voctree
