// How the settings of a run change from its first step to its last. `progress` is the share of the budget that is
// spent, 0..1.
#pragma once

#include "training/slice_adjoint.h"

namespace neuvv::training {

// A phase begins with a change of the tree, which follows the use of its leaves in the phase before (LeafUse):
//   - leaves whose maximum weight is below `prune_below` are removed;
//   - siblings that agree within `merge_within` become one leaf (0: none do);
//   - leaves are emptied in the frames that did not use them;
//   - in the first kLevelsAbovePixel changes all leaves that rays see divide, later the `divide_share` of leaves with
//   the
//     highest opacity sensitivity.
struct Phase {
    double begins;  // progress
    float prune_below;
    float divide_share;
    float merge_within;
};
constexpr Phase kPhases[] = {{0, 0, 0, 0},          {0.01, 0.003f, 1, 0},      {0.05, 0.003f, 1, 0},
                             {0.15, 0.03f, 0, 0},   {0.3, 0.05f, 0.1f, 0.15f}, {0.45, 0.05f, 0.1f, 0.15f},
                             {0.7, 0.05f, 0, 0.15f}};
constexpr uint32_t kPhaseCount = sizeof(kPhases) / sizeof(kPhases[0]);
constexpr uint32_t kLevelsAbovePixel = 2;  // levels that the first tree's leaves lie above those of a pixel's size
constexpr uint32_t kLevelsBelowPixel = 1;  // levels that the finest leaves lie below: edges show half a pixel
// Leaves of the phases before the finest straddle silhouettes: every ray that misses the matter in one thins it, and
// its children are born thin. Their density moves by this share of what it might.
constexpr double kCoarseDensityShare = 0.2;
constexpr double kMinEpochsForPruning = 0.25;    // epochs that a phase needs before "never reached" means anything,
constexpr double kMinEpochsForFrameUse = 1;      // and before it does for single frames
constexpr double kMinEpochsForMaxWeight = 0.05;  // epochs that a phase needs before its reach says what not to divide
constexpr double kMinPixelsToDivide = 0.9;       // a leaf that shows smaller than this in every camera stays whole
constexpr float kMinWeightToDivide = 0.003f;     // leaves that weighed less in every pixel stay coarse
constexpr uint64_t kEarlyBytesFactor = 3;  // times what the file may take in the end may stand before the last change:
                                           // leaves will merge, and pack better as they settle
constexpr uint32_t kMaxTrainingLeaves = 3'000'000;  // 1.3 kB each of device memory at C = 24, n_max = 2

// One ray a pixel, from anywhere in it, finds the shapes sooner; but it must show the pixel's mean itself, which blurs
// edges twice. From this progress on, pixels are means over 2 × 2 rays, as in the images that they are measured by.
constexpr double kSeveralRaysFrom = 0.7;
constexpr uint32_t kSeveralRays = 2;      // per side
constexpr double kSeveralRaysEpochs = 4;  // that must have passed: a short run needs its rays for more pixels

// Steps of one time in a row, all but the first of which need not slice. Where frames share bases, each step also
// moves what other frames see, and four of them in a row unlearn those: 29.3 → 24.7 dB (RESULTS.md).
constexpr uint32_t kBatchesPerFrame = 4;
inline uint32_t batches_in_a_row(const voctree::VOctree& tree) {
    return tree.bases < tree.frames ? 1 : kBatchesPerFrame;
}

constexpr float kTrainingStop = 1.0f / 256;  // rays end where transmittance falls below

constexpr uint32_t kStepsPerRows =
    8;  // A and B move once in so many steps: their sums cost as much as the leaves' moves

LearningRates learning_rates(double progress);

}  // namespace neuvv::training
