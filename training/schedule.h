// How a run's settings change from its first to its last step. `progress` is the share of the budget spent, 0..1.
#pragma once

#include "training/slice_adjoint.h"

namespace neuvv {

// A stage begins with a change of the tree: leaves that no ray of the stage before weighed at least `prune_below` go,
// once rays enough have come to tell; and the first kLevelsAbove times those that count divide.
struct Stage {
    double begins;  // progress
    float prune_below;
};
constexpr Stage kStages[] = {{0, 0}, {0.01, 0.003f}, {0.05, 0.003f}, {0.3, 0.005f}, {0.5, 0.01f}, {0.7, 0.01f}};
constexpr uint32_t kStageCount = sizeof(kStages) / sizeof(kStages[0]);
constexpr uint32_t kLevelsAbove = 2;  // levels that the first tree's leaves lie above the finest
// Leaves of the stages before the finest straddle silhouettes: every ray that misses the matter in one thins it, and
// its children are born thin. Their density moves by this share of what it might.
constexpr double kCoarseDensityShare = 0.2;
constexpr double kDivideCoverage = 0.05;  // epochs that a stage needs before its reach says what not to divide
constexpr float kDivideReach = 0.003f;    // leaves that weighed less in every pixel stay coarse
constexpr uint32_t kMaxTrainingLeaves = 2'000'000;  // 1.3 kB each of device memory at C = 24, n_max = 2

constexpr uint32_t kStepsPerRows =
    8;  // A and B move once in so many steps: their sums cost as much as the leaves' moves

// `leaf_size_m`: edge of the stage's finest leaves; densities are measured against it.
LearningRates learning_rates(double progress, double leaf_size_m);

}  // namespace neuvv
