#include "xr/analogue_input.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/xr/random_poses.h"

namespace neuvv {
namespace {

using test::kNan;

// A character for each update: d: pressed, u: released, h: still down, . : still up.
std::string events(xr::AnalogueButton& press, const std::vector<double>& values) {
    std::string events;
    for (const double value : values) {
        press.update(value);
        EXPECT_FALSE(press.pressed() && press.released());
        EXPECT_EQ(press.pressed() && !press.is_down(), false);
        events += press.pressed() ? 'd' : press.released() ? 'u' : press.is_down() ? 'h' : '.';
    }
    return events;
}

TEST(Press, GoesDownOnceAndUpOnce) {
    xr::AnalogueButton press;
    EXPECT_EQ(events(press, {0, 0.3, 0.69, 0.7, 1, 0.5, 0.41, 0.4, 0.2}), "...dhhhu.");
    EXPECT_FALSE(press.is_down());
}

TEST(Press, DoesNotTrembleBetweenItsThresholds) {
    xr::AnalogueButton press(0.6, 0.5);
    EXPECT_EQ(events(press, {0.59, 0.55, 0.59, 0.6, 0.55, 0.59, 0.51, 0.6, 0.5, 0.55, 0.59}), "...dhhhhu..");
}

TEST(Press, NanIsNoPress) {
    xr::AnalogueButton press;
    EXPECT_EQ(events(press, {kNan, 1, kNan, kNan, 1}), ".du.d");
}

TEST(Press, ResetLetsGoSilently) {
    xr::AnalogueButton press;
    press.update(1);
    press.reset();
    EXPECT_FALSE(press.is_down() || press.pressed() || press.released());
    EXPECT_EQ(events(press, {0, 1}), ".d");
    press.reset();
    EXPECT_EQ(events(press, {1, 1}), "dh") << "the finger is still down";
}

// A character for each update: the direction of the step (l, r, u, d), or a dot.
std::string events(xr::Flick& flick, const std::vector<glm::dvec2>& sticks) {
    std::string events;
    for (const glm::dvec2 stick : sticks) {
        flick.update(stick);
        EXPECT_LE(flick.went_left() + flick.went_right() + flick.went_up() + flick.went_down(), 1);
        events += flick.went_left()    ? 'l'
                  : flick.went_right() ? 'r'
                  : flick.went_up()    ? 'u'
                  : flick.went_down()  ? 'd'
                                       : '.';
    }
    return events;
}

TEST(Flick, StepsOnceAWay) {
    xr::Flick flick;
    EXPECT_EQ(events(flick, {{0, 0}, {0.69, 0}, {0.7, 0}, {1, 0}, {0.36, 0}, {1, 0}, {0.35, 0}, {1, 0}}), "..r....r");
    xr::Flick all;
    EXPECT_EQ(events(all, {{-1, 0}, {0, 0}, {0, 1}, {0, 0}, {0, -1}, {0, 0}, {1, 0}}), "l.u.d.r");
}

TEST(Flick, RoundTheRimIsOneStep) {
    xr::Flick flick;
    std::vector<glm::dvec2> round(100);
    for (size_t i = 0; i < 100; ++i)
        round[i] = {std::cos(0.1 * static_cast<double>(i)), std::sin(0.1 * static_cast<double>(i))};
    EXPECT_EQ(events(flick, round), "r" + std::string(99, '.'));
}

TEST(Flick, TheLargerAxisSaysTheDirection) {
    xr::Flick flick;
    EXPECT_EQ(events(flick, {{0.7, 0.69}, {0, 0}, {-0.7, 0.71}, {0, 0}, {0.7, -0.9}, {0, 0}, {-0.8, -0.8}}), "r.u.d.l");
}

TEST(Flick, ComesBackInBothAxes) {
    xr::Flick flick;
    EXPECT_EQ(events(flick, {{1, 0}, {0.1, 0.6}, {1, 0}, {0.1, 0.3}, {1, 0}}), "r...r");
}

TEST(Flick, NanIsTheMiddle) {
    xr::Flick flick;
    EXPECT_EQ(events(flick, {{kNan, 1}, {kNan, kNan}, {1, kNan}, {kNan, 0.9}}), "u.r.");
}

}  // namespace
}  // namespace neuvv
