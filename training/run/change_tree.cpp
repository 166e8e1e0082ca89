#include "training/run/change_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/threads/parallel.h"
#include "training/run/schedule.h"
#include "training/tree/bases.h"
#include "training/tree/grow.h"
#include "training/tree/merge.h"
#include "training/tree/revive.h"

namespace neuvv::training {

namespace {

// How often leaves live in a frame, summed over leaves and frames. Leaves that rays did not see do not count.
double count_of_lives(const voctree::VOctree& tree, const LeafUse& use) {
    std::vector<double> lives(tree.leaf_count);
    parallel_for(tree.leaf_count, 1024, [&](size_t begin, size_t end) {
        std::vector<float> sigma(tree.frames);
        for (size_t i = begin; i < end; ++i) {
            if (use.max_weight[i] < kMinWeightToDivide) continue;
            voctree::sigma_of_frames(tree, tree.leaf(static_cast<uint32_t>(i)), sigma);
            lives[i] = static_cast<double>(std::count_if(sigma.begin(), sigma.end(), [](float s) { return s > 0; }));
        }
    });
    return std::accumulate(lives.begin(), lives.end(), 0.0);
}

// Whether so few rays are to be expected for each leaf and frame that it lives in that leaves better stay large.
bool are_rays_few(const TreeChange& change, const voctree::VOctree& tree, const LeafUse& use) {
    const RunState& run = change.run;
    if (!change.may_stay_coarse || run.minutes <= 0 || !run.resolution_is_natural || !run.adaptive) return false;
    return change.rays_of_run < kMinRaysOfLeaf * count_of_lives(tree, use);
}

GrowSettings grow_settings(const TreeChange& change, const Phase& phase, bool coarse) {
    const RunState& run = change.run;
    GrowSettings settings;
    settings.max_leaves = change.max_leaves;
    settings.hull_margin = change.hull_margin;
    settings.prune_below = change.looks > kMinEpochsForPruning && run.adaptive ? phase.prune_below : 0;
    settings.empty_unused = change.epochs > kMinEpochsForFrameUse && !coarse;
    settings.divide_share = !coarse && has(run.left_out, OptionalPart::kDivide) ? 0 : phase.divide_share;
    const bool is_performer = run.leaf_pixels <= 0;
    settings.max_depth = run.max_depth + (is_performer && !coarse ? kLevelsBelowPixel : 0);
    settings.min_pixels_to_divide = coarse && is_performer ? 0 : kMinPixelsToDivide;
    // Coarse leaves of surroundings divide until they look as large as they should.
    if (!is_performer) settings.min_pixels_to_divide *= run.leaf_pixels * (coarse ? 2 : 1);
    // Finer leaves need rays: a run that does not see all images in a phase is better without them.
    if (!coarse && change.epochs < kMinEpochsForFrameUse) settings.divide_share = 0;
    // After few rays, a low maximum weight means nothing, so all leaves divide.
    settings.min_weight_to_divide =
        run.adaptive && (!coarse || change.looks > kMinEpochsForMaxWeight) ? kMinWeightToDivide : 0;
    return settings;
}

}  // namespace

double pixels_of_leaves(const RunState& run) {
    if (run.leaf_pixels <= 0) return 1;
    const uint32_t left = first_levels(run.leaf_pixels) - std::min(run.phase, first_levels(run.leaf_pixels));
    return std::pow(run.leaf_pixels * (1u << left), 2);
}

void change_tree(const TreeChange& change, voctree::VOctree& tree, LeafUse use) {
    RunState& run = change.run;
    const Phase& phase = phases_of(run.leaf_pixels)[run.phase];
    const bool coarse =
        run.phase <= first_levels(run.leaf_pixels);  // these phases begin with the division of all leaves
    GrowSettings settings = grow_settings(change, phase, coarse);
    if (run.phase == kLevelsAbovePixel && run.leaf_pixels <= 0 && are_rays_few(change, tree, use)) {
        settings.divide_share = 0;
        settings.max_depth = --run.max_depth;
        settings.carve_kept = true;
    }
    const bool may_merge = change.epochs > kMinEpochsForFrameUse && !has(run.left_out, OptionalPart::kMerge);
    if (phase.merge_within > 0 && may_merge) merge_alike(tree, use, phase.merge_within);
    tree = grow(change.dataset, tree, use, settings);
    if (!coarse && !has(run.left_out, OptionalPart::kRevive)) revive_holes(tree);
}

uint32_t save_within_bytes(const std::filesystem::path& nvv, uint64_t max_bytes, const Dataset& dataset,
                           const voctree::VOctree& tree, const LeafUse& use, ClipSize size) {
    while (size.bytes > max_bytes && size.leaves > 1) {
        GrowSettings settings;
        settings.max_leaves =
            std::clamp(static_cast<uint32_t>(max_bytes * size.leaves / size.bytes), 1u, size.leaves - 1);
        size.leaves = save_compact(nvv, grow(dataset, tree, use, settings), dataset.frame);
        size.bytes = std::filesystem::file_size(nvv);
    }
    return size.leaves;
}

}  // namespace neuvv::training
