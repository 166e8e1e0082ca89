#include "editor/draw/block_grid.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace neuvv {
namespace {

constexpr double kTarget_ms = 40;

struct Drawn {
    double total_ms = 0;
    double slowest_ms = 0;  // of the grid with which the image was finished
    uint32_t side = 0;
    uint32_t begun = 1;  // how often the image was begun
};

// Draws an image whose pixels take full_ms together, and each block fixed_ms more.
Drawn draw(editor::BlockGrid& grid, double fixed_ms, double full_ms, uint32_t min_side = 1) {
    grid.begin(min_side);
    Drawn drawn;
    for (uint32_t block = 0; block < grid.side() * grid.side();) {
        const double ms = fixed_ms + full_ms / (grid.side() * grid.side());
        drawn.total_ms += ms;
        drawn.slowest_ms = std::max(drawn.slowest_ms, ms);
        ++block;
        if (!grid.drawn(ms)) continue;
        block = 0;
        ++drawn.begun;
        drawn.slowest_ms = 0;
    }
    drawn.side = grid.side();
    return drawn;
}

TEST(BlockGrid, BlocksTakeAboutTheTarget) {
    for (const double full_ms : {300.0, 1000.0, 3000.0}) {
        editor::BlockGrid grid(kTarget_ms);
        for (int i = 0; i < 4; ++i) draw(grid, 2, full_ms);
        const Drawn drawn = draw(grid, 2, full_ms);
        EXPECT_EQ(drawn.begun, 1u) << "it is known by now: " << full_ms;
        EXPECT_LE(drawn.slowest_ms, 1.5 * kTarget_ms) << full_ms;
    }
}

// The fixed cost of a block does not shrink with its size.
TEST(BlockGrid, CutsNothingInVain) {
    editor::BlockGrid grid(kTarget_ms);
    const Drawn drawn = draw(grid, 100, 80);
    EXPECT_EQ(drawn.side, 2u);
    EXPECT_LE(drawn.begun, 3u);
    EXPECT_LE(drawn.total_ms, 4 * 120 + 120 + 105);
}

TEST(BlockGrid, GoesBackToFewWhereTheyAreQuick) {
    editor::BlockGrid grid(kTarget_ms);
    draw(grid, 1, 20000);
    EXPECT_EQ(grid.side(), 8u);
    Drawn drawn;
    for (int i = 0; i < 8; ++i) drawn = draw(grid, 1, 20);
    EXPECT_EQ(drawn.side, 1u);
    EXPECT_LE(drawn.slowest_ms, kTarget_ms);
}

TEST(BlockGrid, KeepsToTheLeastAndTheMost) {
    editor::BlockGrid grid(kTarget_ms);
    for (int i = 0; i < 8; ++i) {
        EXPECT_GE(draw(grid, 0, 1, 3).side, 3u);
    }
    EXPECT_LE(draw(grid, 0, 1e9).side, editor::BlockGrid::kMaxSide);
}

}  // namespace
}  // namespace neuvv
