#include "training/tree/grow.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/threads/parallel.h"
#include "base/trace_file.h"
#include "training/tree/bases.h"
#include "training/tree/carved_leaves.h"

namespace neuvv::training {

namespace {

// A leaf that rays hardly use, but that has this optical depth over its edge, counts as hidden by other leaves. It
// stays, as what hides it may become thinner. Without such leaves bodies are hollow, and a hole in their front shows
// what is behind them. Leaves that the hull allows outside all images stay by this rule, too.
constexpr float kHiddenDepth = 0.1f;

bool may_divide(const Dataset& dataset, const voctree::VOctree& tree, const voctree::LeafPosition& position,
                float max_weight, const GrowSettings& settings) {
    if (position.depth >= settings.max_depth || max_weight < settings.min_weight_to_divide) return false;
    if (settings.min_pixels_to_divide <= 0) return true;
    const double edge = static_cast<double>(tree.box_size.x) / (1u << position.depth);
    return edge >= settings.min_pixels_to_divide * footprint_at(dataset, hull_cell(tree, position, 0).centre);
}

// Which leaves divide. One leaf becomes up to eight, so that each may add 7 to the count without exceeding max_leaves.
std::vector<bool> select_divided(const Dataset& dataset, const voctree::VOctree& tree,
                                 const std::vector<voctree::LeafPosition>& positions, const LeafUse& use,
                                 const GrowSettings& settings) {
    std::vector<uint32_t> selected;
    const bool by_sensitivity = settings.divide_share < 1;
    for (uint32_t i = 0; i < positions.size(); ++i) {
        if (by_sensitivity && use.opacity_sensitivity[i] <= 0) continue;
        if (may_divide(dataset, tree, positions[i], use.max_weight[i], settings)) selected.push_back(i);
    }
    size_t room = selected.size();
    if (by_sensitivity) room = static_cast<size_t>(settings.divide_share * static_cast<float>(positions.size()));
    if (settings.max_leaves > 0)
        room =
            std::min(room, settings.max_leaves > positions.size() ? (settings.max_leaves - positions.size()) / 7 : 0);
    if (selected.size() > room) {
        const std::vector<float>& worth = by_sensitivity ? use.opacity_sensitivity : use.max_weight;
        std::stable_sort(selected.begin(), selected.end(), [&](uint32_t a, uint32_t b) { return worth[a] > worth[b]; });
        selected.resize(room);
    }
    std::vector<bool> divided(positions.size());
    for (const uint32_t i : selected) divided[i] = true;
    return divided;
}

// Makes a leaf's σ of each frame, `values`, negative in the frames that did not use the leaf from which it comes,
// unless it is hidden there. Where frames share bases this would make other frames thinner, so nothing changes there.
// `depth` is that of the leaf from which it comes.
void fit_to_use(const voctree::VOctree& tree, const LeafUse& use, uint32_t parent, uint32_t depth,
                std::vector<float>& values) {
    if (tree.bases < tree.frames) return;
    const float below = -density_of(tree, depth, kForbiddenOpacity), hidden = density_of(tree, depth, kHiddenDepth);
    for (uint32_t t = 0; t < tree.frames; ++t) {
        const bool is_used = (use.frames[size_t{t / 32} * tree.leaf_count + parent] >> t % 32 & 1) != 0;
        if (!is_used && values[t] < hidden) values[t] = std::min(values[t], below);
    }
}

// For leaves that rays hardly used: whether it is hidden in some frame.
bool is_hidden(const voctree::VOctree& tree, const voctree::LeafPosition& position, uint32_t leaf) {
    std::vector<float> sigma(tree.frames);
    voctree::sigma_of_frames(tree, tree.leaf(leaf), sigma);
    return *std::max_element(sigma.begin(), sigma.end()) >= density_of(tree, position.depth, kHiddenDepth);
}

// Which leaves are not removed.
std::vector<bool> select_kept(const voctree::VOctree& tree, const std::vector<voctree::LeafPosition>& positions,
                              const std::vector<float>& max_weight, const GrowSettings& settings) {
    std::vector<uint32_t> selected;
    for (uint32_t i = 0; i < max_weight.size(); ++i)
        if (max_weight[i] >= settings.prune_below || is_hidden(tree, positions[i], i)) selected.push_back(i);
    if (settings.max_leaves > 0 && selected.size() > settings.max_leaves) {
        std::stable_sort(selected.begin(), selected.end(),
                         [&](uint32_t a, uint32_t b) { return max_weight[a] > max_weight[b]; });
        selected.resize(settings.max_leaves);
    }
    std::vector<bool> kept(max_weight.size());
    for (const uint32_t i : selected) kept[i] = true;
    return kept;
}

voctree::VOctree same_shape(const voctree::VOctree& tree) {
    voctree::VOctree result = tree;
    result.weights.clear();
    return result;
}

}  // namespace

voctree::VOctree grow(const Dataset& dataset, const voctree::VOctree& tree, const LeafUse& use,
                      const GrowSettings& settings) {
    const std::vector<voctree::LeafPosition> positions = voctree::leaf_positions(tree);
    const std::vector<bool> divided = select_divided(dataset, tree, positions, use, settings);
    const std::vector<bool> stays = select_kept(tree, positions, use.max_weight, settings);
    std::vector<voctree::LeafPosition> grown, children;
    std::vector<uint32_t> parents, origins;  // the leaf from which each of `grown` and `children` comes
    for (uint32_t i = 0; i < positions.size(); ++i) {
        if (!stays[i]) continue;
        if (divided[i]) {
            append_children(children, positions[i]);
            origins.insert(origins.end(), 8, i);
        } else if (settings.carve_kept && positions[i].depth == settings.max_depth) {
            children.push_back(positions[i]);
            origins.push_back(i);
        } else {
            grown.push_back(positions[i]);
            parents.push_back(i);
        }
    }
    const size_t kept = grown.size();
    const Carved carved = keep_allowed(dataset, tree, children, settings.max_depth, settings.hull_margin);
    grown.insert(grown.end(), carved.positions.begin(), carved.positions.end());
    for (const uint32_t child : carved.kept) parents.push_back(origins[child]);
    if (grown.empty()) return tree;  // rays saw nothing: an unchanged tree is better than none

    voctree::VOctree result = same_shape(tree);
    for (const voctree::LeafPosition& position : carved.positions)
        result.node_levels = std::max(result.node_levels, (position.depth + 1) / 2);
    voctree::build_topology(result, grown);
    result.weights.resize(size_t{result.leaf_count} * result.weights_per_leaf());
    const TraceSpan span("weights of the tree");
    const BasisSolver solver(tree.sigma_basis, tree.frames, tree.bases);
    parallel_for(grown.size(), 1024, [&](size_t begin, size_t end) {
        std::vector<float> values(tree.frames);
        for (size_t i = begin; i < end; ++i) {
            const float* parent = tree.leaf(parents[i]);
            float* leaf = result.leaf(static_cast<uint32_t>(i));
            std::memcpy(leaf, parent, sizeof(float) * tree.weights_per_leaf());
            if (i < kept && !settings.empty_unused) continue;
            voctree::sigma_of_frames(tree, parent, values);
            if (settings.empty_unused) fit_to_use(tree, use, parents[i], positions[parents[i]].depth, values);
            if (i >= kept) fit_to_hull(dataset, tree, carved, i - kept, values);
            solver.solve(values.data(), leaf);
        }
    });
    return result;
}

}  // namespace neuvv::training
