// linear_image against sums that are written out.
#include "render/linear_image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace neuvv {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

// 2×1 pixels of four rays each; the second pixel is empty.
const std::vector<glm::vec4> kRays = {{0.4f, 0, 0, 0.5f}, {0, 0.4f, 0, 0.25f}, {}, {}, {}, {1, 1, 1, 1}, {}, {}};
const std::vector<float> kDepth = {2, 4, kInfinity, kInfinity, kInfinity, 8, kInfinity, kInfinity};

// Of so small an angle that lengths along rays are those along its axis.
const stage::Camera kFar{.fx = 1e6, .fy = 1e6, .cx = 1, .cy = 0.5, .width = 2, .height = 1};

TEST(LinearImage, IsTheMeanOfItsRays) {
    const media::LinearImage image = render::linear_image(kRays, kDepth, kFar, 2);
    ASSERT_EQ(image.width, 2u);
    ASSERT_EQ(image.height, 1u);
    const double expected[] = {1.4 / 4, 1.4 / 4, 1.0 / 4, 1.75 / 4, 0, 0, 0, 0};
    for (size_t i = 0; i < 8; ++i) EXPECT_NEAR(image.rgba[i], expected[i], 1e-6) << i;
    EXPECT_NEAR(image.depth_m[0], (0.5 * 2 + 0.25 * 4 + 1 * 8) / 1.75, 1e-5) << "by alpha";
    EXPECT_EQ(image.depth_m[1], kInfinity);
}

TEST(LinearImage, ABackgroundIsBehindTheColourAlone) {
    const media::LinearImage image = render::linear_image(kRays, kDepth, kFar, 2, {0.2f, 0.4f, 0.8f, 0.5f});
    const double clear = 1 - 1.75 / 4;
    const double expected[] = {1.4 / 4 + clear * 0.1,
                               1.4 / 4 + clear * 0.2,
                               1.0 / 4 + clear * 0.4,
                               1.75 / 4 + clear * 0.5,
                               0.1,
                               0.2,
                               0.4,
                               0.5};
    for (size_t i = 0; i < 8; ++i) EXPECT_NEAR(image.rgba[i], expected[i], 1e-6) << i;
    EXPECT_EQ(image.depth_m[1], kInfinity);
}

TEST(LinearImage, DepthIsAlongTheCamerasAxis) {
    const stage::Camera wide{.fx = 1, .fy = 1, .cx = 0.5, .cy = 0.5, .width = 3, .height = 1};
    const std::vector<glm::vec4> solid(3, glm::vec4(1));
    const media::LinearImage image = render::linear_image(solid, std::vector<float>(3, 5), wide, 1);
    EXPECT_NEAR(image.depth_m[0], 5, 1e-5);
    EXPECT_NEAR(image.depth_m[1], 5 / std::sqrt(2), 1e-5);
    EXPECT_NEAR(image.depth_m[2], 5 / std::sqrt(5), 1e-5);
}

}  // namespace
}  // namespace neuvv
