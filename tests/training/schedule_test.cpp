// The run's settings over its budget.
#include "training/schedule.h"

#include <gtest/gtest.h>

namespace neuvv::test {
namespace {

std::vector<float> numbers_of(const training::LearningRates& r) {
    return {r.sigma, r.gamma, r.colour, r.detail, r.sigma_rows, r.gamma_rows};
}

TEST(Schedule, RatesFallFromStartToEndAndStayThere) {
    std::vector<float> before = numbers_of(training::learning_rates(0));
    for (int i = 1; i <= 10; i++) {
        const std::vector<float> now = numbers_of(training::learning_rates(0.1 * i));
        for (size_t j = 0; j < now.size(); j++) {
            EXPECT_GT(now[j], 0);
            EXPECT_LT(now[j], before[j]);
        }
        before = now;
    }
    EXPECT_EQ(numbers_of(training::learning_rates(2)), numbers_of(training::learning_rates(1)));
    EXPECT_EQ(numbers_of(training::learning_rates(-1)), numbers_of(training::learning_rates(0)));
}

TEST(Schedule, StagesBeginInOrder) {
    EXPECT_EQ(training::kPhases[0].begins, 0);
    for (uint32_t i = 1; i < training::kPhaseCount; i++)
        EXPECT_GT(training::kPhases[i].begins, training::kPhases[i - 1].begins);
    EXPECT_LT(training::kPhases[training::kPhaseCount - 1].begins, 1);
    EXPECT_GE(training::kPhaseCount,
              training::kLevelsAbovePixel + 2);  // each level above once, and at least one pruning of the finest leaves
}

}  // namespace
}  // namespace neuvv::test
