#include "voctree/frame_leaves.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/threads/parallel.h"
#include "voctree/sh_weights.h"
#include "voctree/sigmoid.h"

namespace neuvv::voctree {

namespace {

constexpr size_t kTreeLeavesOfPart = 4096;

}  // namespace

std::vector<LiveLeaf> live_leaves(const VOctree& tree, const RowsAtTime& rows, const FrameEdits& edits,
                                  float least_opacity) {
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
    std::erase_if(leaves, [&](const LiveLeaf& leaf) { return leaf.opacity < least_opacity; });
    std::sort(leaves.begin(), leaves.end(), [](const LiveLeaf& a, const LiveLeaf& b) { return a.cell < b.cell; });
    return leaves;
}

LeafColours leaf_colours(const VOctree& tree, uint32_t leaf, const RowsAtTime& rows, const FrameEdits& edits) {
    const float* weights = tree.leaf(leaf) + tree.bases;
    const float angle = row_product(rows.gamma.data(), weights, tree.bases);
    const Radial radial = radial_functions(std::numbers::pi * double{sigmoid(angle)});
    weights += tree.bases;
    LeafColours k{};
    for (auto& channel : k)
        for (uint32_t n = 0; n <= tree.hh_degree; ++n)
            for (uint32_t l = 0; l <= n; ++l)
                for (uint32_t i = 0; i <= 2 * l; ++i) channel[l * l + i] += radial[n][l] * *weights++;
    edits.paint_colours(leaf, tree.hh_degree, k);
    return k;
}

}  // namespace neuvv::voctree
