#include "editor/clock.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace neuvv {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// Four seconds of 25 frames each, playing from 0.
editor::StageClock playing_clock() {
    editor::StageClock clock;
    clock.set_stage(4, 25);
    clock.playing = true;
    return clock;
}

TEST(Playback, PlaysTheWholeStageAgainAndAgain) {
    editor::StageClock clock = playing_clock();
    EXPECT_EQ(clock.in_s(), 0);
    EXPECT_EQ(clock.out_s(), 4);
    EXPECT_EQ(clock.frames(), 100);
    clock.tick(1.5);
    EXPECT_DOUBLE_EQ(clock.time_s(), 1.5);
    EXPECT_EQ(clock.frame(), 37);
    clock.tick(3);
    EXPECT_DOUBLE_EQ(clock.time_s(), 0.5) << "what was left of the step goes on";
    clock.playing = false;
    clock.tick(1);
    EXPECT_DOUBLE_EQ(clock.time_s(), 0.5);
}

TEST(Playback, ShowsWholeImagesWhileItPlays) {
    editor::StageClock clock = playing_clock();
    clock.tick(1.07);
    EXPECT_DOUBLE_EQ(clock.time_s(), 1.07);
    EXPECT_DOUBLE_EQ(clock.displayed_s(), 1.04);
    EXPECT_DOUBLE_EQ(clock.displayed_after_s(1), 1.08);
    EXPECT_DOUBLE_EQ(clock.displayed_after_s(2), 1.12);
    clock.speed = 0.5;
    EXPECT_DOUBLE_EQ(clock.displayed_s(), 1.06) << "as many a second where it is slower";
    EXPECT_DOUBLE_EQ(clock.displayed_after_s(1), 1.08);
    clock.speed = -2;
    EXPECT_DOUBLE_EQ(clock.displayed_s(), 1.04);
    EXPECT_DOUBLE_EQ(clock.displayed_after_s(1), 1.0);
    clock.speed = 1;
    clock.play_or_pause();
    EXPECT_DOUBLE_EQ(clock.time_s(), 1.04) << "what was seen stays";
    clock.playing = true;
    clock.scrub(1.07);
    EXPECT_NEAR(clock.until_next_s(), 0.01, 1e-12);
    clock.speed = -2;
    EXPECT_NEAR(clock.until_next_s(), 0.015, 1e-12);
    clock.step(-1);
    EXPECT_DOUBLE_EQ(clock.time_s(), 1.0) << "the one before what was seen";
    clock.speed = 1;
    EXPECT_EQ(clock.until_next_s(), kInfinity) << "it stands still";
    clock.scrub(1.07);
    EXPECT_DOUBLE_EQ(clock.displayed_s(), 1.07) << "a stage may stand still between two";
    clock.playing = true;
    clock.scrub(3.98);
    EXPECT_DOUBLE_EQ(clock.displayed_after_s(1), 0) << "it goes on at the other end";
    clock.set_range(0.05, 4);
    clock.scrub(0.06);
    EXPECT_DOUBLE_EQ(clock.displayed_s(), 0.05) << "nothing before the range";
}

TEST(Playback, DoesNotDrift) {
    editor::StageClock clock = playing_clock();
    clock.set_range(1, 3.3);
    clock.scrub(1);
    constexpr int kTicks = 1'000'000;
    for (int i = 0; i < kTicks; ++i) clock.tick(1.0 / 144);
    const double expected = 1 + std::fmod(kTicks / 144.0, 2.3);
    EXPECT_NEAR(clock.time_s(), expected, 1e-7);
}

TEST(Playback, GoesAtItsSpeedAndBackwards) {
    editor::StageClock clock = playing_clock();
    clock.speed = 0.25;
    clock.tick(2);
    EXPECT_DOUBLE_EQ(clock.time_s(), 0.5);
    clock.speed = -2;
    clock.tick(0.5);
    EXPECT_DOUBLE_EQ(clock.time_s(), 3.5) << "past the start";
    clock.tick(100);
    EXPECT_NEAR(clock.time_s(), 3.5, 1e-12) << "fifty rounds";
    clock.speed = 0;
    clock.tick(1);
    EXPECT_NEAR(clock.time_s(), 3.5, 1e-12);
}

TEST(Playback, StaysInItsRangeAndPlaysIntoIt) {
    editor::StageClock clock = playing_clock();
    clock.set_range(1, 2);
    EXPECT_EQ(clock.time_s(), 0);
    clock.tick(0.9);
    EXPECT_DOUBLE_EQ(clock.time_s(), 0.9) << "before the range";
    for (int i = 0; i < 100; ++i) {
        clock.tick(0.31);
        ASSERT_GE(clock.time_s(), 1);
        ASSERT_LT(clock.time_s(), 2);
    }
    clock.scrub(3);
    clock.tick(0.25);
    EXPECT_DOUBLE_EQ(clock.time_s(), 1.25) << "behind the range";
    clock.scrub(3);
    clock.speed = -1;
    clock.tick(0.5);
    EXPECT_DOUBLE_EQ(clock.time_s(), 2.5);
    clock.tick(1.75);
    EXPECT_DOUBLE_EQ(clock.time_s(), 1.75);
}

TEST(Playback, StopsAtTheEndWhereItDoesNotLoop) {
    editor::StageClock clock = playing_clock();
    clock.loops = false;
    clock.set_range(1, 2);
    clock.scrub(1.5);
    clock.tick(0.6);
    EXPECT_FALSE(clock.playing);
    EXPECT_DOUBLE_EQ(clock.time_s(), 1.96) << "the last image of the range";
    clock.playing = true;
    clock.speed = -1;
    clock.tick(5);
    EXPECT_FALSE(clock.playing);
    EXPECT_DOUBLE_EQ(clock.time_s(), 1);
}

TEST(Playback, StepsFromImageToImage) {
    editor::StageClock clock = playing_clock();
    clock.tick(0.99);  // between the frames 24 and 25
    clock.step(1);
    EXPECT_FALSE(clock.playing);
    EXPECT_EQ(clock.time_s(), 25 / 25.0);
    clock.scrub(0.99);
    clock.step(-1);
    EXPECT_EQ(clock.time_s(), 24 / 25.0);
    for (int i = 0; i < 1000; ++i) clock.step(1);
    EXPECT_EQ(clock.time_s(), 24 / 25.0) << "ten rounds, exactly";
    clock.step(-25);
    EXPECT_EQ(clock.frame(), 99);
    clock.step(1);
    EXPECT_EQ(clock.frame(), 0);
}

TEST(Playback, StepsReachEveryImageOfUnevenRates) {
    editor::StageClock clock;
    clock.set_stage(1001 * 3 / 30000.0 * 10, 30000 / 1001.0);
    ASSERT_EQ(clock.frames(), 30);
    for (int64_t i = 1; i <= 60; ++i) {
        clock.step(1);
        ASSERT_EQ(clock.frame(), i % 30);
    }
    for (int64_t i = 1; i <= 60; ++i) {
        clock.step(-1);
        ASSERT_EQ(clock.frame(), (60 - i) % 30);
    }
}

TEST(Playback, StepsStayInTheRange) {
    editor::StageClock clock = playing_clock();
    clock.set_range(1, 2);
    clock.scrub(1);
    clock.step(-1);
    EXPECT_EQ(clock.frame(), 49);
    clock.step(2);
    EXPECT_EQ(clock.frame(), 26);
    clock.loops = false;
    clock.step(1000);
    EXPECT_EQ(clock.frame(), 49);
    clock.step(-1000);
    EXPECT_EQ(clock.frame(), 25);
    clock.scrub(3);
    clock.step(1);
    EXPECT_EQ(clock.frame(), 76) << "outside, the stage's ends hold";
    clock.step(1000);
    EXPECT_EQ(clock.frame(), 99);
}

TEST(Playback, RangesAreCutToTheStage) {
    editor::StageClock clock = playing_clock();
    clock.set_range(9, -3);
    EXPECT_EQ(clock.in_s(), 0);
    EXPECT_EQ(clock.out_s(), 4);
    clock.set_range(2, 2);
    EXPECT_EQ(clock.in_s(), 2);
    EXPECT_DOUBLE_EQ(clock.out_s(), 2.04) << "an image at least";
    clock.set_range(4, 4);
    EXPECT_DOUBLE_EQ(clock.in_s(), 3.96);
    EXPECT_DOUBLE_EQ(clock.out_s(), 4);
    clock.set_range(kNan, 1);
    EXPECT_DOUBLE_EQ(clock.in_s(), 3.96);
}

TEST(Playback, AnotherDurationKeepsWhatItCan) {
    editor::StageClock clock = playing_clock();
    clock.scrub(3);
    clock.set_stage(6, 30);
    EXPECT_EQ(clock.out_s(), 6) << "the whole stays the whole";
    EXPECT_EQ(clock.time_s(), 3);
    clock.set_range(1, 5);
    clock.set_stage(2, 30);
    EXPECT_EQ(clock.in_s(), 1);
    EXPECT_EQ(clock.out_s(), 2);
    EXPECT_EQ(clock.time_s(), 2);
    EXPECT_EQ(clock.frame(), 59);
}

TEST(Playback, AStageWithoutDurationStandsStill) {
    editor::StageClock clock;
    clock.set_stage(0, 25);
    clock.playing = true;
    clock.tick(1);
    clock.step(3);
    clock.scrub(5);
    EXPECT_EQ(clock.time_s(), 0);
    EXPECT_EQ(clock.frame(), 0);
    EXPECT_EQ(clock.frames(), 1);
    clock.set_stage(2, 25);
    EXPECT_EQ(clock.out_s(), 2);
}

TEST(Playback, StrangeNumbersMoveNothing) {
    editor::StageClock clock = playing_clock();
    clock.scrub(1);
    for (const double strange : {kNan, kInfinity, -kInfinity, -1.0, 0.0}) {
        clock.tick(strange);
        EXPECT_EQ(clock.time_s(), 1);
        if (std::isfinite(strange)) continue;
        clock.scrub(strange);
        EXPECT_EQ(clock.time_s(), 1);
    }
    clock.speed = kNan;
    clock.tick(1);
    EXPECT_EQ(clock.time_s(), 1);
    clock.scrub(99);
    EXPECT_EQ(clock.time_s(), 4);
    clock.scrub(-99);
    EXPECT_EQ(clock.time_s(), 0);
}

TEST(Playback, PlaysAnewFromWhereItWouldStop) {
    editor::StageClock clock;
    clock.set_stage(4, 25);
    clock.loops = false;
    clock.scrub(3.96);
    clock.play_or_pause();
    EXPECT_TRUE(clock.playing);
    EXPECT_EQ(clock.time_s(), 0);
    clock.tick(0.52);
    EXPECT_DOUBLE_EQ(clock.time_s(), 0.52);
    clock.play_or_pause();
    EXPECT_FALSE(clock.playing);
    EXPECT_DOUBLE_EQ(clock.time_s(), 0.52) << "a pause stays where it is";
    clock.play_or_pause();
    EXPECT_DOUBLE_EQ(clock.time_s(), 0.52);
    clock.playing = false;
    clock.speed = -1;
    clock.scrub(0);
    clock.play_or_pause();
    EXPECT_DOUBLE_EQ(clock.time_s(), 3.96) << "backwards from the last image";
    clock.playing = false;
    clock.loops = true;
    clock.scrub(0);
    clock.play_or_pause();
    EXPECT_EQ(clock.time_s(), 0) << "a loop needs no other start";
}

}  // namespace
}  // namespace neuvv
