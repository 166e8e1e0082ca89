// Sets of pixels against what each function says, pixel by pixel.
#include "training/tree/pixel_mask.h"

#include <gtest/gtest.h>

#include <string>

namespace neuvv::test {
namespace {

using training::PixelMask;

PixelMask mask_of(const std::vector<std::string>& rows) {
    PixelMask mask(static_cast<uint32_t>(rows[0].size()), static_cast<uint32_t>(rows.size()));
    for (size_t i = 0; i < mask.size(); ++i) mask.set[i] = rows[i / mask.width][i % mask.width] == '#';
    return mask;
}

std::vector<std::string> rows_of(const PixelMask& mask) {
    std::vector<std::string> rows(mask.height, std::string(mask.width, '.'));
    for (size_t i = 0; i < mask.size(); ++i)
        if (mask[i]) rows[i / mask.width][i % mask.width] = '#';
    return rows;
}

using Rows = std::vector<std::string>;

TEST(PixelMasks, GrowAndShrinkBySquares) {
    const PixelMask dot = mask_of({".....", ".....", "...#.", "....."});
    EXPECT_EQ(rows_of(training::grown(dot, 1)), Rows({".....", "..###", "..###", "..###"}));
    EXPECT_EQ(rows_of(training::shrunk(training::grown(dot, 1), 1)), Rows({".....", ".....", "...##", "...##"}))
        << "beyond the image, all is set";
    EXPECT_EQ(rows_of(training::grown(mask_of({"...", "..."}), 1)), Rows({"...", "..."}));
}

TEST(PixelMasks, CloseGaps) {
    const std::string none = ".............";
    const Rows apart{none, none, none, none, "....#...#....", none, none, none, none};
    Rows joined = apart;
    joined[4] = "....#####....";
    EXPECT_EQ(rows_of(training::closed(mask_of(apart), 2)), joined);
    EXPECT_EQ(rows_of(training::closed(mask_of(apart), 1)), apart);
}

TEST(PixelMasks, AreDividedIntoParts) {
    std::vector<size_t> sizes;
    training::for_each_part(mask_of({"##..#", "..#..", "....#"}),
                            [&](const std::vector<size_t>& part) { sizes.push_back(part.size()); });
    EXPECT_EQ(sizes, std::vector<size_t>({3, 1, 1})) << "corners touch";
}

TEST(PixelMasks, AreFilledToConvexParts) {
    const PixelMask frame = mask_of({"#####....", "#...#....", "#...#...#", "#####...."});
    EXPECT_EQ(rows_of(training::convex_parts(frame, 1, 1)), Rows({"#####....", "#####....", "#####....", "#####...."}))
        << "the speck is left out";
    const PixelMask corners = mask_of({"#.......#", ".........", ".........", "#........"});
    EXPECT_EQ(rows_of(training::convex_parts(corners, 4, 0)),
              Rows({"#########", "######...", "####.....", "#........"}));
}

TEST(PixelMasks, EncloseWhatTheBackgroundCannotReach) {
    const PixelMask walls = mask_of({".........", ".####....", ".#..#.#..", ".#..#.##.", ".#..#.#.."});
    const PixelMask limit = mask_of({".........", ".#######.", ".#######.", ".#######.", ".#######."});
    EXPECT_EQ(rows_of(training::enclosed(walls, limit)),
              Rows({".........", ".####....", ".####.#..", ".####.##.", ".####.#.."}))
        << "a body that the image's end cuts is closed by it";
}

}  // namespace
}  // namespace neuvv::test
