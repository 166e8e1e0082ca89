// How a run's settings change from its first to its last step. `progress` is the share of the budget spent, 0..1.
#pragma once

#include "training/slice_adjoint.h"

namespace neuvv {

// Levels that the first tree lies above the finest leaves, and when each next stage begins.
constexpr uint32_t kStages = 4;  // the last one only prunes
constexpr uint32_t kLevelsAbove = 2;
constexpr double kStageBegins[kStages] = {0, 0.05, 0.18, 0.5};

constexpr uint32_t kStepsPerRows =
    8;  // A and B move once in so many steps: their sums cost as much as the leaves' moves

// `leaf_size_m`: edge of the finest leaves; densities are measured against it.
LearningRates learning_rates(double progress, double leaf_size_m);

}  // namespace neuvv
