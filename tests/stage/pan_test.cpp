// The gains of two loudspeakers for a sound at a place.
#include "stage/sound/pan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace neuvv::test::pan_test {
namespace {

constexpr double kCentre = std::numbers::sqrt2 / 2;  // of both sides, for a sound that is straight ahead

TEST(Pan, GoesFromLeftToRightWithTheSamePower) {
    for (int degrees = -90; degrees <= 90; degrees += 15) {
        const double angle = degrees * std::numbers::pi / 180;
        const auto [left, right] = stage::pan_gains({1.5 * std::sin(angle), 0, -1.5 * std::cos(angle)});
        EXPECT_NEAR(left * left + right * right, 1, 1e-6);
        EXPECT_NEAR(right * right - left * left, std::sin(std::numbers::pi / 2 * std::sin(angle)), 1e-6);
    }
    EXPECT_NEAR(stage::pan_gains({-2, 0, 0})[0], 1, 1e-6);
    EXPECT_NEAR(stage::pan_gains({-2, 0, 0})[1], 0, 1e-6);
    EXPECT_NEAR(stage::pan_gains({0, 0, 2})[0], kCentre, 1e-6) << "behind";
    EXPECT_NEAR(stage::pan_gains({0, 0, 0})[1], kCentre, 1e-6) << "at the ear";
}

TEST(Pan, IsHalfAsLoudAtTwiceTheDistance) {
    EXPECT_EQ(stage::distance_gain(0), 1);
    EXPECT_EQ(stage::distance_gain(stage::kUsualDistance_m), 1);
    EXPECT_EQ(stage::distance_gain(2 * stage::kUsualDistance_m), 0.5);
    EXPECT_NEAR(stage::pan_gains({0, 0, -8})[0], kCentre / 4, 1e-6);
}

}  // namespace
}  // namespace neuvv::test::pan_test
