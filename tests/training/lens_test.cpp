// Lenses against values by the formulas of calibration programs, and images whose distortion is undone.
#include "interchange/camera/lens.h"

#include <gtest/gtest.h>

#include <cmath>

#include "training/data/undistort.h"

namespace neuvv {
namespace {

interchange::Lens make_lens(interchange::LensModel model, std::array<double, 6> k, double p1 = 0, double p2 = 0,
                            double s1 = 0, double s2 = 0) {
    return {.model = model,
            .fx = 500,
            .fy = 480,
            .cx = 320,
            .cy = 240,
            .k = k,
            .p1 = p1,
            .p2 = p2,
            .s1 = s1,
            .s2 = s2,
            .width = 640,
            .height = 480};
}

constexpr double kPlaces[3][2] = {{0.3, -0.2}, {-0.5, 0.4}, {0, 0.6}};

// The expected values were computed from the formulas in the documentation of OpenCV and COLMAP, with other code.
void expect_projections(const interchange::Lens& lens, const double (&expected)[3][2]) {
    for (int i = 0; i < 3; ++i) {
        const glm::dvec2 at = interchange::project(lens, {kPlaces[i][0], kPlaces[i][1]});
        EXPECT_NEAR(at.x, expected[i][0], 1e-8) << i;
        EXPECT_NEAR(at.y, expected[i][1], 1e-8) << i;
    }
    EXPECT_EQ(interchange::project(lens, {0, 0}), glm::dvec2(320, 240));
}

// The direction that is shown at a pixel is the one that is projected there.
TEST(Lens, DirectionsAreThoseThatAreProjected) {
    using interchange::LensModel;
    for (const interchange::Lens& lens :
         {make_lens(LensModel::kPinhole, {}), make_lens(LensModel::kBrown, {-0.12, 0.03, 0.002}, 0.001, -0.002),
          make_lens(LensModel::kFisheye, {-0.12, 0.03, 0.002})})
        for (const auto& [x, y] : kPlaces) {
            const auto found = interchange::direction_at(lens, interchange::project(lens, {x, y}));
            ASSERT_TRUE(found);
            EXPECT_LT(glm::distance(*found, glm::dvec2(x, y)), 1e-8);
        }
    EXPECT_FALSE(interchange::direction_at(make_lens(LensModel::kBrown, {-0.5}), {2000, 240}))
        << "beyond where the lens folds over";
}

TEST(Lens, Pinhole) {
    const interchange::Lens lens = make_lens(interchange::LensModel::kPinhole, {});
    expect_projections(lens, {{470, 144}, {70, 432}, {320, 528}});
    EXPECT_FALSE(lens.distorts());
}

TEST(Lens, Brown) {
    const interchange::Lens lens =
        make_lens(interchange::LensModel::kBrown, {-0.25, 0.08, -0.01, 0.03, -0.02, 0.005}, 0.002, -0.003);
    expect_projections(lens, {{464.222110865, 147.697849046}, {92.763267531, 414.439090536}, {319.46, 503.750772518}});
    EXPECT_TRUE(lens.distorts());
    EXPECT_FALSE(make_lens(interchange::LensModel::kBrown, {}).distorts());
}

TEST(Lens, Fisheye) {
    const interchange::Lens lens = make_lens(interchange::LensModel::kFisheye, {0.05, -0.02, 0.01, -0.003});
    expect_projections(lens, {{464.787295409, 147.336130938}, {94.427000595, 413.240063543}, {320.0, 502.805754288}});
    EXPECT_TRUE(make_lens(interchange::LensModel::kFisheye, {}).distorts())
        << "its angles are not a pinhole's tangents";
}

TEST(Lens, ThinPrismFisheye) {
    const interchange::Lens lens =
        make_lens(interchange::LensModel::kFisheye, {0.05, -0.02, 0.01, -0.003}, 0.002, -0.003, 0.004, -0.006);
    expect_projections(lens,
                       {{464.487924213, 147.336130938}, {93.67936756, 413.316013566}, {320.146026618, 502.805754288}});
}

TEST(Lens, Fov) {
    const interchange::Lens lens = make_lens(interchange::LensModel::kFov, {0.9});
    expect_projections(lens, {{474.942377154, 140.836878621}, {79.669084812, 424.574142864}, {320.0, 520.178075247}});
    EXPECT_NEAR(interchange::project(make_lens(interchange::LensModel::kFov, {1e-12}), {0.3, -0.2}).x, 470, 1e-6);
}

TEST(Lens, ScalingMovesPlacesWithTheImage) {
    const interchange::Lens lens = make_lens(interchange::LensModel::kBrown, {-0.25, 0.08}, 0.002, -0.003);
    const glm::dvec2 whole = interchange::project(lens, {0.3, -0.2}),
                     half = interchange::project(interchange::scaled(lens, 320, 120), {0.3, -0.2});
    EXPECT_NEAR(half.x, whole.x / 2, 1e-9);
    EXPECT_NEAR(half.y, whole.y / 4, 1e-9);
}

// r (1 + k1 r²) turns back at r = √(−1 / 3 k1).
TEST(Lens, FoldingIsFound) {
    EXPECT_NEAR(interchange::fold_radius(make_lens(interchange::LensModel::kBrown, {-0.3}), 2), std::sqrt(1 / 0.9),
                1e-3);
    EXPECT_EQ(interchange::fold_radius(make_lens(interchange::LensModel::kBrown, {-0.3}), 1), 1);
    EXPECT_EQ(interchange::fold_radius(make_lens(interchange::LensModel::kBrown, {0.3}), 2), 2);
    EXPECT_LT(interchange::fold_radius(make_lens(interchange::LensModel::kBrown, {0.3, 0, 0, -1}), 2),
              1.01);  // there is a pole at r = 1
    EXPECT_LT(interchange::fold_radius(make_lens(interchange::LensModel::kBrown, {}, 0.3), 2),
              2);  // by the tangential terms alone
    EXPECT_EQ(interchange::fold_radius(make_lens(interchange::LensModel::kFisheye, {}), 100), 100);
    // θ (1 − θ²/2) turns back at θ = √(2/3)
    EXPECT_NEAR(interchange::fold_radius(make_lens(interchange::LensModel::kFisheye, {-0.5}), 2),
                std::tan(std::sqrt(2.0 / 3)), 1e-3);
    EXPECT_LT(interchange::fold_radius(make_lens(interchange::LensModel::kBrown, {NAN}), 2), 0.001);
}

media::Image noise(uint32_t width, uint32_t height) {
    media::Image image(width, height);
    uint32_t state = 7;
    for (uint8_t& byte : image.rgba) byte = static_cast<uint8_t>((state = state * 1664525 + 1013904223) >> 24);
    for (size_t i = 0; i < image.rgba.size(); i += 4)
        if (image.rgba[i + 3] == 0) image.rgba[i + 3] = 1;  // as clear pixels would lose their colour
    return image;
}

TEST(Undistort, APinholeChangesNothing) {
    const training::Undistortion map = training::make_undistortion(make_lens(interchange::LensModel::kPinhole, {}));
    EXPECT_EQ(map.seen_share, 1);
    EXPECT_EQ(map.fold_degrees, 0);
    const media::Image image = noise(640, 480);
    EXPECT_EQ(training::undistort(image, map, training::ColourOf::kCapture).rgba, image.rgba);
    EXPECT_EQ(training::undistort(image, map, training::ColourOf::kForeground).rgba, image.rgba);
    EXPECT_TRUE(training::undistort_ignored({}, map).empty());
    std::vector<bool> ignored(640 * 480);
    ignored[777] = true;
    EXPECT_EQ(training::undistort_ignored(ignored, map), ignored);
}

// The brightness of a board of squares in front of the camera, in normalised coordinates. Edges are soft over a few
// pixels.
double board(glm::dvec2 xy) {
    return 0.5 + 0.45 * std::tanh(3 * std::sin(20 * xy.x) * std::sin(20 * xy.y));
}

// The image of the board through a lens. The direction that a pixel's centre shows is found by a search.
media::Image board_through(const interchange::Lens& lens) {
    media::Image image(lens.width, lens.height);
    for (uint32_t y = 0; y < lens.height; ++y)
        for (uint32_t x = 0; x < lens.width; ++x) {
            const glm::dvec2 goal(x + 0.5, y + 0.5);
            glm::dvec2 xy = (goal - glm::dvec2(lens.cx, lens.cy)) / glm::dvec2(lens.fx, lens.fy);
            for (int i = 0; i < 25; ++i) xy += (goal - interchange::project(lens, xy)) / glm::dvec2(lens.fx, lens.fy);
            const auto value = static_cast<uint8_t>(std::lround(255 * media::srgb_from_linear(board(xy))));
            std::fill_n(image.at(x, y), 3, value);
            image.at(x, y)[3] = 255;
        }
    return image;
}

TEST(Undistort, AnyLensShowsTheBoardAsAPinholeDoes) {
    for (const interchange::Lens& full :
         {make_lens(interchange::LensModel::kBrown, {0.08, 0.01}, 0.004, -0.003),
          make_lens(interchange::LensModel::kBrown, {-0.2, 0.05}, 0.002, 0.003),
          make_lens(interchange::LensModel::kFisheye, {0.02, -0.01}), make_lens(interchange::LensModel::kFov, {0.6})}) {
        const interchange::Lens lens = interchange::scaled(full, 200, 150);
        interchange::Lens pinhole = lens;
        pinhole.model = interchange::LensModel::kPinhole;
        const training::Undistortion map = training::make_undistortion(lens);
        const media::Image straight = training::undistort(board_through(lens), map, training::ColourOf::kForeground);
        const media::Image truth = board_through(pinhole), bent = board_through(lens);
        double error = 0, without = 0;
        size_t seen = 0;
        for (size_t i = 0; i < map.positions.size(); ++i) {
            if (!map.sees(i)) {
                EXPECT_EQ(straight.rgba[4 * i + 3], 0);
                continue;
            }
            ++seen;
            error += std::abs(straight.rgba[4 * i] - truth.rgba[4 * i]);
            without += std::abs(bent.rgba[4 * i] - truth.rgba[4 * i]);
        }
        EXPECT_EQ(map.seen_share, static_cast<double>(seen) / (200 * 150));
        EXPECT_GT(map.seen_share, 0.8);
        EXPECT_LT(error / static_cast<double>(seen), 1) << without / static_cast<double>(seen);
        EXPECT_GT(without / static_cast<double>(seen), 4) << "the comparison must be able to fail";
    }
}

TEST(Undistort, WhatTheLensNeverSawIsIgnored) {
    const interchange::Lens pincushion = make_lens(interchange::LensModel::kBrown, {0.4});
    const training::Undistortion map = training::make_undistortion(pincushion);
    EXPECT_FALSE(map.sees(0)) << "the corner of the pinhole's image lies outside the lens's";
    EXPECT_TRUE(map.sees(240 * 640 + 320));
    std::vector<bool> ignored = training::undistort_ignored({}, map);
    ASSERT_EQ(ignored.size(), 640u * 480);
    EXPECT_TRUE(ignored[0]);
    EXPECT_FALSE(ignored[240 * 640 + 320]);
    std::vector<bool> centre(640 * 480);
    centre[240 * 640 + 320] = true;
    EXPECT_TRUE(training::undistort_ignored(centre, map)[240 * 640 + 320]);

    const training::Undistortion folded = training::make_undistortion(make_lens(interchange::LensModel::kBrown, {-2}));
    EXPECT_NEAR(folded.fold_degrees, std::atan(std::sqrt(1.0 / 6)) * 180 / 3.14159265, 0.1);
    EXPECT_FALSE(folded.sees(0)) << "the distortion would bring it back into the image";
    EXPECT_LT(folded.seen_share, 0.8);
}

// In foregrounds, clear pixels must not darken the colour beside them; in captures, they count like all others.
TEST(Undistort, ColourIsWeightedByAlpha) {
    interchange::Lens lens = make_lens(interchange::LensModel::kPinhole, {});
    lens.width = 2;
    lens.height = 1;
    training::Undistortion map = training::make_undistortion(lens);
    map.positions[0] = {1, 0.5f};  // half-way between the two pixels
    media::Image image(2, 1);
    const uint8_t pixels[8] = {200, 100, 0, 255, 0, 0, 0, 0};
    std::copy(pixels, pixels + 8, image.rgba.begin());
    const media::Image foreground = training::undistort(image, map, training::ColourOf::kForeground);
    EXPECT_EQ(foreground.at(0, 0)[0], 200);
    EXPECT_EQ(foreground.at(0, 0)[3], 128);
    const media::Image capture = training::undistort(image, map, training::ColourOf::kCapture);
    EXPECT_NEAR(capture.at(0, 0)[0], 255 * media::srgb_from_linear(0.5 * media::linear_from_srgb(200 / 255.0)), 0.51);
}

}  // namespace
}  // namespace neuvv
