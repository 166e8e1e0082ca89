#include "editor/draw/dynamic_scale.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace neuvv {
namespace {

// A device on which an image takes fixed + full · scale² milliseconds, with relative noise of up to `noise`.
struct Simulated {
    double fixed_ms, full_ms, noise = 0;
    std::mt19937 random{7};

    double milliseconds(double scale) {
        const double off = std::uniform_real_distribution<double>(-noise, noise)(random);
        return (fixed_ms + full_ms * scale * scale) * (1 + off);
    }
    double ideal(double target_ms) const {
        return std::clamp(std::sqrt(std::max(target_ms - fixed_ms, 0.0) / full_ms), editor::kMinScale, 1.0);
    }
};

// Draws so many images and returns their scales.
std::vector<double> draw(editor::DynamicScale& control, Simulated& device, int images) {
    std::vector<double> scales;
    for (int i = 0; i < images; ++i) {
        scales.push_back(control.scale());
        control.drawn(control.scale(), device.milliseconds(control.scale()));
    }
    return scales;
}

constexpr double kFrameTarget_ms = 30;
const Simulated kDevices[] = {{0, 5},   {0, 60},    {2, 100},  {10, 200}, {20, 50},
                              {1, 700}, {25, 3000}, {50, 300}, {3, 27.5}};

TEST(DynamicScale, ConvergesWithinAFewImages) {
    for (Simulated device : kDevices)
        for (const double first : {editor::kMinScale, 0.5, 1.0}) {
            editor::DynamicScale control(kFrameTarget_ms, first);
            draw(control, device, 16);
            const double ideal_ms = device.milliseconds(device.ideal(kFrameTarget_ms));
            EXPECT_NEAR(device.milliseconds(control.scale()), ideal_ms,
                        2.2 * editor::DynamicScale::kMinChange * ideal_ms)
                << device.fixed_ms << " + " << device.full_ms << " from " << first;
            const double settled = control.scale();
            for (const double scale : draw(control, device, 100)) EXPECT_EQ(scale, settled) << "without noise";
        }
}

TEST(DynamicScale, GoesDownQuickly) {
    for (Simulated device : kDevices) {
        editor::DynamicScale control(kFrameTarget_ms, 1);
        draw(control, device, 3);
        const double ideal = device.ideal(kFrameTarget_ms);
        EXPECT_LE(device.milliseconds(control.scale()), 1.25 * std::max(kFrameTarget_ms, device.milliseconds(ideal)))
            << device.fixed_ms << " + " << device.full_ms;
    }
}

TEST(DynamicScale, GoesUpSlowly) {
    editor::DynamicScale control(kFrameTarget_ms, editor::kMinScale);
    Simulated device{0, 1};
    const std::vector<double> scales = draw(control, device, 30);
    for (size_t i = 1; i < scales.size(); ++i)
        EXPECT_LE(scales[i], scales[i - 1] * editor::DynamicScale::kMaxGrowth + 1e-12);
    EXPECT_EQ(scales.back(), 1);
}

TEST(DynamicScale, DoesNotOscillateWithNoise) {
    for (Simulated device : kDevices) {
        device.noise = 0.2;
        editor::DynamicScale control(kFrameTarget_ms);
        draw(control, device, 30);
        const double ideal = device.ideal(kFrameTarget_ms);
        const std::vector<double> scales = draw(control, device, 1000);
        int changes = 0;
        for (size_t i = 1; i < scales.size(); ++i) changes += scales[i] != scales[i - 1];
        EXPECT_LE(changes, 50) << device.fixed_ms << " + " << device.full_ms;
        const auto [min, max] = std::minmax_element(scales.begin(), scales.end());
        EXPECT_GE(*min, 0.75 * ideal) << device.fixed_ms << " + " << device.full_ms;
        EXPECT_LE(*max, 1.25 * ideal) << device.fixed_ms << " + " << device.full_ms;
    }
}

TEST(DynamicScale, FollowsAnotherView) {
    for (const double noise : {0.0, 0.2}) {
        Simulated device{2, 60, noise};
        editor::DynamicScale control(kFrameTarget_ms);
        draw(control, device, 30);
        device.full_ms = 600;
        draw(control, device, 4);
        EXPECT_LE(2 + 600 * control.scale() * control.scale(), 1.3 * kFrameTarget_ms);
        device.full_ms = 30;
        draw(control, device, 25);
        EXPECT_NEAR(control.scale(), device.ideal(kFrameTarget_ms), 0.15);
    }
}

TEST(DynamicScale, LearnsWhatDoesNotDependOnTheSize) {
    Simulated device{10, 200};
    editor::DynamicScale control(kFrameTarget_ms);
    for (int i = 0; i < 20; ++i) control.drawn(i % 2 ? 0.2 : 0.8, device.milliseconds(i % 2 ? 0.2 : 0.8));
    EXPECT_NEAR(control.fixed_ms(), 10, 2);
    EXPECT_NEAR(control.full_ms(), 200, 10);
}

TEST(DynamicScale, HopelessTargetsTakeTheLeast) {
    editor::DynamicScale control(1);
    for (int i = 0; i < 20; ++i) control.drawn(i % 2 ? 0.2 : 1, i % 2 ? 50 : 60);
    EXPECT_EQ(control.scale(), editor::kMinScale);
}

TEST(DynamicScale, StrangeTimesAreIgnored) {
    editor::DynamicScale control(kFrameTarget_ms);
    for (const double strange :
         {0.0, -1.0, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::quiet_NaN()}) {
        control.drawn(0.5, strange);
        control.drawn(strange, 10);
    }
    EXPECT_EQ(control.scale(), 0.5);
    EXPECT_EQ(control.full_ms(), 0);
}

}  // namespace
}  // namespace neuvv
