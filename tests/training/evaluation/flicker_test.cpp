// Flicker is what changes in renders beyond what changes in the truth.
#include "training/evaluation/flicker.h"

#include <gtest/gtest.h>

namespace neuvv {
namespace {

// Two pixels of a performer, and a white one.
media::Image image_of(uint8_t first, uint8_t second) {
    media::Image image(3, 1);
    image.rgba = {first, first, first, 255, second, second, second, 255, 255, 255, 255, 255};
    return image;
}

TEST(Flicker, CountsWhatTheTruthDoesNot) {
    training::FlickerMeter meter(1, 4);
    meter.add(0, 0, image_of(10, 20), image_of(12, 20));
    meter.add(0, 1, image_of(10, 50), image_of(15, 53));  // still: 3; moving: 33 in place of 30
    meter.add(0, 2, image_of(10, 50), image_of(15, 53));
    meter.add(0, 3, image_of(10, 50), image_of(20, 43));
    ASSERT_TRUE(meter.step(0));
    EXPECT_DOUBLE_EQ(meter.step(0)->still, 3);
    EXPECT_DOUBLE_EQ(meter.step(0)->moving, 3);
    EXPECT_DOUBLE_EQ(meter.step(1)->still, 0);
    EXPECT_DOUBLE_EQ(meter.step(2)->still, 7.5);
    const auto summary = meter.summary({2});
    ASSERT_TRUE(summary);
    EXPECT_EQ(summary->cut_count, 1u);
    EXPECT_DOUBLE_EQ(summary->cuts.still, 7.5);
    EXPECT_DOUBLE_EQ(summary->others.still, 3) << "the upper of two";
    EXPECT_FALSE(meter.summary({0, 1, 2})) << "there is nothing to compare with";
}

TEST(Flicker, TheBackgroundDoesNotCount) {
    const uint8_t black[3] = {};
    for (const bool black_behind : {false, true}) {
        training::FlickerMeter meter(1, 3, black_behind ? black : media::kWhite);
        meter.add(0, 0, image_of(10, 0), image_of(10, 0));
        meter.add(0, 1, image_of(10, 0), image_of(13, 9));
        EXPECT_DOUBLE_EQ(meter.step(0)->still, black_behind ? 1.5 : 6) << "with the white pixel, or the black one";
    }
}

TEST(Flicker, ComparesNeighboursOfACameraAlone) {
    training::FlickerMeter meter(2, 3);
    meter.add(0, 0, image_of(10, 20), image_of(10, 20));
    meter.add(1, 1, image_of(90, 90), image_of(90, 90));
    meter.add(0, 2, image_of(10, 20), image_of(80, 80));
    EXPECT_FALSE(meter.step(0));
    EXPECT_FALSE(meter.step(1));
    EXPECT_FALSE(meter.summary({}));
}

}  // namespace
}  // namespace neuvv
