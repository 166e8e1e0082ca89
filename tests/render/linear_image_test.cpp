// linear_image against sums that are written out, and the rows that it gets.
#include "render/rays/linear_image.h"
#include "gpu/host_copies.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "render/rays/view_layout.h"
#include "support/gpu_test.h"

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

struct RowsOfView : test::GpuTest {};

// Of two views of more bytes than one piece, whose edges cut tiles.
TEST_F(RowsOfView, AreThoseOfTheirView) {
    constexpr uint32_t kWidth = 2053, kHeight = 2051;
    const render::ViewLayout layout{kWidth, kHeight, 1, 2};
    const auto value = [](uint32_t view, uint32_t x, uint32_t y) { return glm::vec4(x, y, view, 1); };
    std::vector<glm::vec4> tiles(size_t{layout.ray_tiles()} * kTilePixels, glm::vec4(-1));
    ASSERT_GT(tiles.size() / 2 * sizeof(glm::vec4), gpu::kStagedPiece);
    for (uint32_t view = 0; view < 2; ++view)
        for (uint32_t y = 0; y < kHeight; ++y)
            for (uint32_t x = 0; x < kWidth; ++x) {
                const size_t tile =
                    (size_t{view} * layout.tiles_down() + y / kTile) * layout.tiles_across() + x / kTile;
                tiles[tile * kTilePixels + y % kTile * kTile + x % kTile] = value(view, x, y);
            }
    const gpu::Buffer buffer(device(), "rays", tiles.size() * sizeof(glm::vec4), gpu::MemoryKind::kDevice);
    gpu::upload(device(), buffer, tiles.data(), buffer.bytes);
    for (uint32_t view = 0; view < 2; ++view) {
        const std::vector<glm::vec4> rows = render::rows_of_view<glm::vec4>(device(), buffer, layout, view);
        ASSERT_EQ(rows.size(), size_t{kWidth} * kHeight);
        size_t wrong = 0;
        for (uint32_t y = 0; y < kHeight; ++y)
            for (uint32_t x = 0; x < kWidth; ++x) wrong += rows[size_t{y} * kWidth + x] != value(view, x, y);
        EXPECT_EQ(wrong, 0u);
    }
}

}  // namespace
}  // namespace neuvv
