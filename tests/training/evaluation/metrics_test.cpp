#include "training/evaluation/metrics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "training/data/contact_sheet.h"
#include "training/evaluation/evaluate.h"
#include "training/evaluation/flip.h"

namespace neuvv {
namespace {

media::Image filled(uint32_t width, uint32_t height, uint8_t value) {
    media::Image image(width, height);
    for (uint8_t& byte : image.rgba) byte = value;
    return image;
}

media::Image random_image(uint32_t width, uint32_t height, uint32_t seed) {
    std::mt19937 random(seed);
    media::Image image(width, height);
    for (uint8_t& byte : image.rgba) byte = static_cast<uint8_t>(random());
    return image;
}

// The image, blurred and with noise: a plausible render of it.
media::Image degraded(const media::Image& image, uint32_t seed, int noise) {
    std::mt19937 random(seed);
    media::Image result = image;
    for (size_t i = 4; i + 4 < image.rgba.size(); ++i) {
        const int mean = (image.rgba[i - 4] + image.rgba[i] + image.rgba[i + 4]) / 3;
        const int shift = static_cast<int>(random() % static_cast<uint32_t>(2 * noise + 1)) - noise;
        result.rgba[i] = static_cast<uint8_t>(std::clamp(mean + shift, 0, 255));
    }
    return result;
}

// SSIM as Wang et al. 2004 define it: means, variances about them and covariance, over each whole window.
double plain_ssim(const media::Image& a, const media::Image& b) {
    constexpr int kSide = 11;
    double weights[kSide][kSide], sum = 0;
    for (int v = 0; v < kSide; ++v)
        for (int u = 0; u < kSide; ++u)
            sum += weights[v][u] = std::exp(-((u - 5) * (u - 5) + (v - 5) * (v - 5)) / (2 * 1.5 * 1.5));
    double total = 0;
    int windows = 0;
    for (size_t c = 0; c < 3; ++c)
        for (uint32_t y = 0; y + kSide <= a.height; ++y)
            for (uint32_t x = 0; x + kSide <= a.width; ++x, ++windows) {
                const auto mean = [&](auto&& value) {
                    double result = 0;
                    for (uint32_t v = 0; v < kSide; ++v)
                        for (uint32_t u = 0; u < kSide; ++u)
                            result += weights[v][u] / sum *
                                      value(a.at(x + u, y + v)[c] / 255.0, b.at(x + u, y + v)[c] / 255.0);
                    return result;
                };
                const double mean_a = mean([](double p, double) { return p; });
                const double mean_b = mean([](double, double q) { return q; });
                const double var_a = mean([&](double p, double) { return (p - mean_a) * (p - mean_a); });
                const double var_b = mean([&](double, double q) { return (q - mean_b) * (q - mean_b); });
                const double cov = mean([&](double p, double q) { return (p - mean_a) * (q - mean_b); });
                const double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
                total += (2 * mean_a * mean_b + c1) * (2 * cov + c2) /
                         ((mean_a * mean_a + mean_b * mean_b + c1) * (var_a + var_b + c2));
            }
    return total / windows;
}

TEST(Metrics, EqualImagesArePerfect) {
    const media::Image image = random_image(20, 15, 1);
    const training::Quality quality = training::compare(image, image);
    EXPECT_EQ(quality.psnr, 99);
    EXPECT_EQ(quality.mae, 0);
    EXPECT_NEAR(quality.ssim, 1, 1e-12);
}

TEST(Metrics, ByHand) {
    const media::Image grey = filled(16, 12, 100);
    const training::Quality shifted = training::compare(grey, filled(16, 12, 151));  // 51/255 = 0.2
    EXPECT_NEAR(shifted.mae, 0.2, 1e-12);
    EXPECT_NEAR(shifted.psnr, -10 * std::log10(0.04), 1e-12);
    const double a = 100 / 255.0, b = 151 / 255.0;  // without variance, only the luminance term is left
    EXPECT_NEAR(shifted.ssim, (2 * a * b + 1e-4) / (a * a + b * b + 1e-4), 1e-12);

    media::Image one = grey;  // will differ in one channel of one of 192 pixels
    one.at(3, 4)[1] = 202;
    const training::Quality single = training::compare(grey, one);
    EXPECT_NEAR(single.mae, 0.4 / (3 * 192), 1e-12);
    EXPECT_NEAR(single.psnr, -10 * std::log10(0.16 / (3 * 192)), 1e-12);

    const training::Quality opposite = training::compare(filled(11, 11, 0), filled(11, 11, 255));
    EXPECT_NEAR(opposite.psnr, 0, 1e-12);
    EXPECT_NEAR(opposite.mae, 1, 1e-12);
    EXPECT_LT(opposite.ssim, 0.001);
}

TEST(Metrics, FlipIsTheMeanOfItsImage) {
    const media::Image truth = random_image(30, 20, 8), render = degraded(truth, 9, 10);
    EXPECT_EQ(training::compare(truth, render).flip, training::mean_of(training::flip(truth, render)));
    EXPECT_GT(training::compare(truth, render).flip, 0.01);
    EXPECT_EQ(training::compare(truth, truth).flip, 0);
}

TEST(Metrics, AlphaIsIgnored) {
    media::Image a = random_image(14, 14, 2), b = a;
    for (size_t i = 3; i < b.rgba.size(); i += 4) b.rgba[i] = static_cast<uint8_t>(~b.rgba[i]);
    EXPECT_EQ(training::compare(a, b).psnr, 99);
}

TEST(Metrics, SsimMatchesThePlainDefinition) {
    const struct {
        uint32_t width, height;
        int noise;
    } cases[] = {{11, 11, 20}, {12, 30, 3}, {33, 17, 60}, {24, 24, 0}};
    for (const auto& c : cases) {
        const media::Image truth = random_image(c.width, c.height, c.width);
        const media::Image render = degraded(truth, 7, c.noise);
        const double expected = plain_ssim(truth, render);
        EXPECT_NEAR(training::compare(truth, render).ssim, expected, 1e-9);
        EXPECT_LT(expected, 0.95);
        EXPECT_NEAR(training::compare(render, truth).ssim, expected, 1e-9) << "symmetric";
    }
    const media::Image noise = random_image(40, 40, 3);
    EXPECT_NEAR(training::compare(noise, random_image(40, 40, 4)).ssim, plain_ssim(noise, random_image(40, 40, 4)),
                1e-9);
}

TEST(Metrics, SmallImagesHaveASmallerWindow) {
    for (const uint32_t side : {1u, 2u, 10u}) {
        const media::Image image = random_image(side, 4, 5);
        EXPECT_NEAR(training::compare(image, image).ssim, 1, 1e-12);
        EXPECT_LT(training::compare(filled(side, 4, 10), filled(side, 4, 200)).ssim, 0.5);
    }
}

TEST(Metrics, ErrorImageIsWhiteFromAQuarter) {
    media::Image truth = filled(3, 1, 100), result = truth;
    result.at(1, 0)[0] = 110;
    result.at(2, 0)[2] = 0;
    const media::Image error = training::error_image(truth, result);
    EXPECT_EQ(error.rgba, (std::pmr::vector<uint8_t>{0, 0, 0, 255, 40, 0, 0, 255, 0, 0, 255, 255}));
    EXPECT_EQ(training::error_image(result, truth).rgba, error.rgba);
}

TEST(Metrics, ContactSheetPlacesAndScales) {
    media::Image red(4, 4), clear(4, 2), large(9, 3);
    for (size_t i = 0; i < red.rgba.size(); i += 4) red.rgba[i] = red.rgba[i + 3] = 255;
    for (size_t i = 0; i < large.rgba.size(); i += 4) large.rgba[i + 3] = 255;  // black
    const media::Image sheet = training::contact_sheet({red, clear, large}, 2, 4);
    ASSERT_EQ(sheet.width, 8u);
    ASSERT_EQ(sheet.height, 8u);
    const auto rgb = [&](uint32_t x, uint32_t y) {
        return std::vector<int>{sheet.at(x, y)[0], sheet.at(x, y)[1], sheet.at(x, y)[2]};
    };
    const std::vector<int> white = {255, 255, 255}, black = {0, 0, 0};
    EXPECT_EQ(rgb(0, 0), (std::vector<int>{255, 0, 0}));
    EXPECT_EQ(rgb(3, 3), (std::vector<int>{255, 0, 0}));
    EXPECT_EQ(rgb(5, 1), white);  // clear over white
    EXPECT_EQ(rgb(0, 5), black);  // 9×3 pixels divided by three are 3×1, in the cell's centre
    EXPECT_EQ(rgb(2, 5), black);
    EXPECT_EQ(rgb(3, 5), white);
    EXPECT_EQ(rgb(0, 4), white);
    EXPECT_EQ(rgb(0, 6), white);
    EXPECT_EQ(training::contact_sheet({}, 3, 10).width, 0u);
}

TEST(Metrics, ContactSheetEnlargesSmallImages) {
    media::Image small(2, 1);
    small.at(0, 0)[3] = small.at(1, 0)[3] = 255;
    small.at(1, 0)[1] = 200;
    const media::Image sheet = training::contact_sheet({small}, 1, 7);  // scaled by 3 to 6×3 pixels
    ASSERT_EQ(sheet.width, 6u);
    ASSERT_EQ(sheet.height, 3u);
    for (uint32_t y = 0; y < 3; ++y)
        for (uint32_t x = 0; x < 6; ++x) {
            EXPECT_EQ(sheet.at(x, y)[0], 0) << x << " " << y;
            EXPECT_EQ(sheet.at(x, y)[1], x < 3 ? 0 : 200) << x << " " << y;
        }
}

TEST(Metrics, ContactSheetHasCellsOfTheShapeOfItsImages) {
    media::Image wide(16, 9), tall(2, 8);
    for (size_t i = 0; i < wide.rgba.size(); i += 4) wide.rgba[i + 3] = 255;
    for (size_t i = 0; i < tall.rgba.size(); i += 4) tall.rgba[i + 3] = 255;
    const media::Image wides = training::contact_sheet({wide, wide, wide}, 2, 16);
    EXPECT_EQ(wides.width, 32u);
    EXPECT_EQ(wides.height, 18u);
    EXPECT_EQ(wides.at(15, 17)[0], 0);
    EXPECT_EQ(wides.at(16, 17)[0], 255) << "the fourth cell is empty";
    const media::Image both = training::contact_sheet({wide, tall}, 2, 16);
    EXPECT_EQ(both.width, 32u);
    EXPECT_EQ(both.height, 16u);
    EXPECT_EQ(both.at(0, 2)[0], 255);
    EXPECT_EQ(both.at(0, 3)[0], 0) << "nine of sixteen rows, in the middle";
    EXPECT_EQ(both.at(21, 0)[0], 255);
    EXPECT_EQ(both.at(22, 0)[0], 0) << "four of sixteen columns, in the middle";
}

// A view of 64×48 pixels whose matte fills columns 10 to 29 and rows 20 to 34, but for the first of its pixels.
training::View view_with_matte() {
    media::Image image = filled(64, 48, 0);
    for (uint32_t y = 20; y < 35; ++y)
        for (uint32_t x = 10; x < 30; ++x) image.at(x, y)[3] = x == 10 && y == 20 ? 0 : 1;
    training::View view;
    view.image = training::TiledImage(image);
    return view;
}

TEST(ComparedPart, IsTheRectangleThatHoldsTheMatte) {
    const training::View view = view_with_matte();
    const media::Image image = random_image(64, 48, 1);
    const media::Image part = training::compared_part(image, view, training::ComparedPart::kRectangle);
    ASSERT_EQ(part.width, 20u);
    ASSERT_EQ(part.height, 15u);
    EXPECT_TRUE(std::equal(part.at(0, 0), part.at(0, 0) + 80, image.at(10, 20)));
    EXPECT_TRUE(std::equal(part.at(0, 14), part.at(0, 14) + 80, image.at(10, 34)));
    EXPECT_EQ(training::compared_part(image, view, training::ComparedPart::kImage).rgba, image.rgba);
    const media::Image wide = training::compared_part(image, view, training::ComparedPart::kRectangle, 60);
    ASSERT_EQ(wide.width, 60u);
    ASSERT_EQ(wide.height, 48u) << "no more than the image has";
    EXPECT_TRUE(std::equal(wide.at(0, 0), wide.at(0, 0) + 240, image.at(4, 0)));
    training::View empty;
    empty.image = training::TiledImage(filled(64, 48, 0));
    EXPECT_EQ(training::compared_part(image, empty, training::ComparedPart::kMatte).rgba, image.rgba);
}

TEST(ComparedPart, ErrorsOutsideItDoNotCount) {
    using training::ComparedPart;
    const training::View view = view_with_matte();
    const media::Image truth = filled(64, 48, 100);
    const auto psnr = [&](uint32_t x, uint32_t y, ComparedPart part) {
        media::Image render = truth;
        for (int c = 0; c < 3; ++c) render.at(x, y)[c] = 151;  // by a fifth of 255
        return training::compare_part(truth, render, view, part).psnr;
    };
    const auto of_pixels = [](double count) { return -10 * std::log10(0.04 / count); };
    EXPECT_NEAR(psnr(12, 22, ComparedPart::kImage), of_pixels(64 * 48), 1e-9);
    EXPECT_NEAR(psnr(12, 22, ComparedPart::kRectangle), of_pixels(20 * 15), 1e-9);
    EXPECT_NEAR(psnr(12, 22, ComparedPart::kMatte), of_pixels(20 * 15 - 1), 1e-9);
    EXPECT_NEAR(psnr(10, 20, ComparedPart::kRectangle), of_pixels(20 * 15), 1e-9) << "in the rectangle, not the matte";
    EXPECT_EQ(psnr(10, 20, ComparedPart::kMatte), 99);
    EXPECT_EQ(psnr(9, 20, ComparedPart::kRectangle), 99);
    EXPECT_EQ(training::compare_part(truth, random_image(64, 48, 2), view, ComparedPart::kMatte).ssim,
              training::compare_part(truth, random_image(64, 48, 2), view, ComparedPart::kRectangle).ssim);
}

}  // namespace
}  // namespace neuvv
