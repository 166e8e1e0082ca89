// FLIP: known values, and properties that every metric has.
#include "training/evaluation/flip.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/random_tree.h"

namespace neuvv::test {
namespace {

media::Image uniform_image(uint8_t r, uint8_t g, uint8_t b) {
    media::Image image(48, 32);
    for (size_t i = 0; i < image.rgba.size(); i += 4) {
        const uint8_t pixel[] = {r, g, b, 255};
        std::copy_n(pixel, 4, &image.rgba[i]);
    }
    return image;
}

media::Image noise_image(uint64_t seed) {
    Random random(seed);
    media::Image image(48, 32);
    for (uint8_t& byte : image.rgba) byte = static_cast<uint8_t>(random.below(256));
    return image;
}

// An image that is black to the left of column `edge` and white from there on.
media::Image edge_image(uint32_t edge) {
    media::Image image = uniform_image(0, 0, 0);
    for (uint32_t y = 0; y < image.height; ++y)
        for (uint32_t x = edge; x < image.width; ++x) std::fill_n(image.at(x, y), 3, static_cast<uint8_t>(255));
    return image;
}

TEST(Flip, IdenticalImagesDoNotDiffer) {
    const media::Image image = noise_image(1);
    const std::vector<float> errors = training::flip(image, image);
    EXPECT_EQ(errors.size(), 48u * 32u);
    EXPECT_EQ(*std::max_element(errors.begin(), errors.end()), 0);
}

TEST(Flip, UniformImagesDifferByTheirColoursAlone) {
    // By hand: HyAB of black and white is ΔL* = 100; the error is 0.95 plus the share (100^0.7 − 0.4·c) / (0.6·c) of
    // the top twentieth, c = 41.276.
    for (const float error : training::flip(uniform_image(0, 0, 0), uniform_image(255, 255, 255)))
        EXPECT_NEAR(error, 0.9676, 1e-3);
    // The two colours whose difference is the metric's largest by definition.
    for (const float error : training::flip(uniform_image(0, 255, 0), uniform_image(0, 0, 255)))
        EXPECT_NEAR(error, 1, 1e-6);
    // A step of 1/255 in mid-grey: ΔL* = 0.39, which gives 0.39^0.7 · 0.95 / 16.51.
    for (const float error : training::flip(uniform_image(128, 128, 128), uniform_image(129, 129, 129)))
        EXPECT_NEAR(error, 0.030, 0.002);
}

TEST(Flip, IsSymmetricAndBounded) {
    const std::vector<float> ab = training::flip(noise_image(1), noise_image(2)),
                             ba = training::flip(noise_image(2), noise_image(1));
    for (size_t i = 0; i < ab.size(); ++i) {
        EXPECT_NEAR(ab[i], ba[i], 1e-12);
        EXPECT_GE(ab[i], 0);
        EXPECT_LE(ab[i], 1);
    }
}

TEST(Flip, AShiftedEdgeIsSeenWhereItIs) {
    const std::vector<float> errors = training::flip(edge_image(24), edge_image(26));
    EXPECT_GT(errors[48 * 16 + 25], 0.8);
    EXPECT_LT(errors[48 * 16 + 2], 1e-6);
    EXPECT_LT(errors[48 * 16 + 46], 1e-6);
}

TEST(Flip, GrowsWithTheDifferenceAndFadesWithDistance) {
    const media::Image grey = uniform_image(100, 100, 100);
    double last = 0;
    for (const uint8_t value : std::initializer_list<uint8_t>{101, 105, 120, 160, 250}) {
        const double error = training::mean_of(training::flip(grey, uniform_image(value, 100, 100)));
        EXPECT_GT(error, last);
        last = error;
    }
    // From twice the distance, fine noise looks like a uniform grey.
    EXPECT_LT(training::mean_of(training::flip(noise_image(1), noise_image(2), 2 * training::kPixelsPerDegree)),
              training::mean_of(training::flip(noise_image(1), noise_image(2))));
}

TEST(Flip, TheImageGoesFromBlackToYellow) {
    const media::Image image = training::flip_image({0, 0.5f, 1}, 3, 1);
    EXPECT_EQ(std::vector<uint8_t>(image.rgba.begin(), image.rgba.begin() + 4), (std::vector<uint8_t>{0, 0, 4, 255}));
    EXPECT_EQ(std::vector<uint8_t>(image.rgba.end() - 4, image.rgba.end()), (std::vector<uint8_t>{252, 253, 191, 255}));
    EXPECT_EQ(image.at(1, 0)[0], 182);  // between 159 and 205
}

}  // namespace
}  // namespace neuvv::test
