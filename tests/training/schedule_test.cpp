// How a run's settings change over its budget.
#include "training/run/schedule.h"

#include <gtest/gtest.h>

#include <cmath>

namespace neuvv::test {
namespace {

std::vector<float> numbers_of(const training::LearningRates& r) {
    return {r.sigma, r.gamma, r.colour, r.detail, r.sigma_rows, r.gamma_rows};
}

TEST(Schedule, RatesFallFromStartToEndAndStayThere) {
    std::vector<float> before = numbers_of(training::learning_rates(0, 9));
    for (int i = 1; i <= 10; ++i) {
        const std::vector<float> now = numbers_of(training::learning_rates(0.1 * i, 9));
        for (size_t j = 0; j < now.size(); ++j) {
            EXPECT_GT(now[j], 0);
            EXPECT_LT(now[j], before[j]);
        }
        before = now;
    }
    EXPECT_EQ(numbers_of(training::learning_rates(2, 9)), numbers_of(training::learning_rates(1, 9)));
    EXPECT_EQ(numbers_of(training::learning_rates(-1, 9)), numbers_of(training::learning_rates(0, 9)));
}

TEST(Schedule, LongRunsEndWithLowerRates) {
    const auto last = [](double epochs) { return training::learning_rates(1, epochs); };
    EXPECT_EQ(numbers_of(last(0)), numbers_of(last(training::kShortRunEpochs)));
    const training::LearningRates once = last(9), twice = last(18);
    EXPECT_FLOAT_EQ(twice.colour, once.colour / 2);
    EXPECT_FLOAT_EQ(twice.detail, once.detail / 2);
    EXPECT_FLOAT_EQ(twice.gamma, once.gamma / 2);
    EXPECT_FLOAT_EQ(twice.sigma, once.sigma / std::sqrt(2.0f));
    EXPECT_EQ(numbers_of(last(1e3)), numbers_of(last(1e9)));  // not lower than the least share
    EXPECT_FLOAT_EQ(last(1e9).colour, static_cast<float>(training::kLeastLastRate) * once.colour);
    EXPECT_EQ(numbers_of(training::learning_rates(0, 1e9)), numbers_of(training::learning_rates(0, 0)));
}

TEST(Schedule, OpacityIsSmootherWhereImagesAgreeLess) {
    const double least = training::kSmoothedError;
    EXPECT_EQ(training::smoothness_factor(0), 1);
    EXPECT_EQ(training::smoothness_factor(least), 1);
    EXPECT_FLOAT_EQ(training::smoothness_factor(3 * least), 3);
    EXPECT_FLOAT_EQ(training::smoothness_factor(1), static_cast<float>(training::kMostSmoothing));
}

TEST(Schedule, StagesBeginInOrder) {
    EXPECT_EQ(training::kPhases[0].begins, 0);
    for (uint32_t i = 1; i < training::kPhaseCount; ++i)
        EXPECT_GT(training::kPhases[i].begins, training::kPhases[i - 1].begins);
    EXPECT_LT(training::kPhases[training::kPhaseCount - 1].begins, 1);
    EXPECT_GE(training::kPhaseCount,
              training::kLevelsAbovePixel + 2);  // one phase per level above, and at least one pruning of finest leaves
}

}  // namespace
}  // namespace neuvv::test
