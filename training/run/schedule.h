// How the settings of a run change from its first step to its last. `progress` is the share of the budget that is
// spent, 0..1.
#pragma once

#include <array>
#include <cstdint>

#include "training/step/slice_adjoint.h"
#include "training/tree/surroundings_tree.h"

namespace neuvv::training {

// A phase begins with a change of the tree, which follows how rays used its leaves in the phase before (LeafUse):
// siblings that agree within `merge_within` become one leaf (0: none do), leaves whose maximum weight is below
// `prune_below` are removed, leaves are emptied in frames that did not use them, and some divide. In the first
// kLevelsAbovePixel changes all leaves that rays see divide, later the `divide_share` of leaves with the highest
// opacity sensitivity.
struct Phase {
    double begins;  // progress
    float prune_below;
    float divide_share;
    float merge_within;
};
constexpr std::array<Phase, 7> kPhases = {{{0, 0, 0, 0},
                                           {0.01, 0.003f, 1, 0},
                                           {0.05, 0.003f, 1, 0},
                                           {0.15, 0.03f, 0, 0},
                                           {0.3, 0.05f, 0.1f, 0.15f},
                                           {0.45, 0.05f, 0.1f, 0.15f},
                                           {0.7, 0.05f, 0, 0.15f}}};
constexpr uint32_t kPhaseCount = kPhases.size();
// Those of surroundings (surroundings_tree.h), where leaves that rays see divide kSurroundingsLevels times. Their first
// leaves fill all space, and need longer to show which of them are empty.
constexpr std::array<Phase, kPhaseCount> kSurroundingsPhases = {{{0, 0, 0, 0},
                                                                 {0.06, 0.002f, 1, 0},
                                                                 {0.14, 0.002f, 1, 0},
                                                                 {0.22, 0.004f, 1, 0},
                                                                 {0.32, 0.006f, 1, 0.15f},
                                                                 {0.5, 0.05f, 0.1f, 0.15f},
                                                                 {0.75, 0.05f, 0, 0.15f}}};

// The leaves of the first tree lie so many levels above leaves of a pixel's size, the finest leaves so many below: with
// half a pixel they show edges sharply.
constexpr uint32_t kLevelsAbovePixel = 2, kLevelsBelowPixel = 1;
// The same, and the phases, of either kind of tree: `leaf_pixels` is RunState::leaf_pixels.
constexpr uint32_t first_levels(double leaf_pixels) {
    return leaf_pixels > 0 ? kSurroundingsLevels : kLevelsAbovePixel;
}
constexpr const std::array<Phase, kPhaseCount>& phases_of(double leaf_pixels) {
    return leaf_pixels > 0 ? kSurroundingsPhases : kPhases;
}

// Leaves of half the size are seen by a quarter as many rays each, and a step of as many rays takes more than twice as
// long. In a budget of minutes, the last of the divisions above is therefore left out where fewer rays are to be
// expected, at the speed so far, for each leaf and frame that it lives in: larger leaves that are seen often show more
// than small ones that are not. This applies only where the user left the resolution to
// the program.
constexpr double kMinRaysOfLeaf = 70;

// The share of the learning rate of densities that applies until all leaves have a pixel's size. Larger leaves lie
// across silhouettes: each ray that passes beside the performer through such a leaf makes it thinner, and its children
// would inherit too little density.
constexpr double kCoarseDensityShare = 0.2;

// A leaf without density gets no gradient, so what a step too far has emptied would stay empty. Leaves at silhouettes,
// which many rays only brush, met that end sooner or later, and long runs ate away outlines (RESULTS.md, "Outlines that
// long runs ate away"). So a density does not fall below this optical depth over the leaf's edge, where each frame has
// a basis of its own. The changes of the tree remove leaves that rays hardly use, and compact.h empties those
// that are thin at the end.
constexpr float kLeastDepth = 0.003f;
// Runs of fewer epochs do without the bound: too few steps have gone wrong in them, and they need their rays for less.
constexpr double kBoundedEpochs = 15;

// What a run can leave out, so that it can be measured what each of these is worth: `divide`, that leaves of high
// opacity sensitivity divide; `merge`, that siblings that agree become one leaf; `revive`, that holes get a little
// density; `bound`, kLeastDepth; `rays`, the several rays per pixel at the end.
enum class OptionalPart : uint32_t { kDivide, kMerge, kRevive, kBound, kRays };
constexpr std::array<const char*, 5> kOptionalParts = {"divide", "merge", "revive", "bound", "rays"};

// A set of optional parts: the bit 1 << part for each.
using OptionalParts = uint32_t;
inline bool has(OptionalParts parts, OptionalPart part) {
    return (parts >> static_cast<uint32_t>(part) & 1u) != 0;
}

// How many epochs a phase needs before its LeafUse is trusted. Before the first, "no ray saw this leaf" may only mean
// that few rays were traced; before the second, the same holds for single frames; before the third, a low maximum
// weight is no reason not to divide a leaf.
constexpr double kMinEpochsForPruning = 0.25, kMinEpochsForFrameUse = 1, kMinEpochsForMaxWeight = 0.05;

constexpr double kMinPixelsToDivide = 0.9;    // smaller leaves do not divide (GrowSettings::min_pixels_to_divide)
constexpr float kMinWeightToDivide = 0.003f;  // leaves of lower maximum weight do not divide

// Before the last change of the tree, its file may be larger than the bound by this factor, as leaves will still merge
// and pack better once they have settled.
constexpr uint64_t kEarlyBytesFactor = 3;
constexpr uint32_t kMaxTrainingLeaves = 3'000'000;  // each takes 1.3 kB of device memory at C = 24, n_max = 2

// One ray per pixel, from a random position in it, finds shapes sooner than several. But such a ray has to show the
// mean of its pixel, which blurs edges a second time. From this progress on, and after at least so many epochs, a pixel
// is the mean of 2 × 2 rays, as in the images by which quality is measured. A short run needs its rays for more pixels
// instead.
constexpr double kSeveralRaysFrom = 0.7;
constexpr double kSeveralRaysEpochs = 4;
constexpr uint32_t kSeveralRays = 2;  // along each side of a pixel

// The smoothness of opacity has its weight in the loss where images agree to this squared error of a colour channel,
// and in proportion more where they agree less, up to so many times: noise, lossy compression and mattes of real images
// leave ten times the error of rendered ones, and then what single rays say of single leaves is worth less.
constexpr double kSmoothedError = 5e-4, kMostSmoothing = 16;
float smoothness_factor(double squared_error);
// The share of one step in the running mean of that error.
constexpr double kErrorShare = 0.02;

// The progress at which a run that tries what cameras' colours need chooses what it goes on to learn: leaves are as
// large as pixels by then, and colours have settled.
constexpr double kChoosesColoursAt = 0.15;

// How many steps in a row are at the same time; all but the first of them need not slice. Where frames share bases,
// each step also changes what other frames show, and four steps in a row make those worse: 29.3 → 24.7 dB.
constexpr uint32_t kBatchesPerFrame = 4;
inline uint32_t batches_in_a_row(const voctree::VOctree& tree) {
    return tree.bases < tree.frames ? 1 : kBatchesPerFrame;
}

// The last rates of runs of so many epochs; those of longer runs are lower in proportion, down to the least share.
constexpr double kShortRunEpochs = 9, kLeastLastRate = 0.2;

// A and B move in every eighth step: their sums take as long as moving the weights of leaves.
constexpr uint32_t kStepsPerRows = 8;

// These fall exponentially with progress. `epochs`: how many the whole run will have. A run of many epochs sees every
// pixel so often that low rates at its end still reach it, and then renders have less noise; a short one needs higher
// rates to get anywhere.
LearningRates learning_rates(double progress, double epochs);
float camera_colour_rate(double progress);

}  // namespace neuvv::training
