// How much of an eye's image is drawn: it shrinks at once, grows late, and does not flicker.
#include "tools/headset/draw/drawn_share.h"

#include <gtest/gtest.h>

namespace neuvv::headset {
namespace {

double after(DrawnShare& share, double scale, uint32_t images) {
    for (uint32_t i = 0; i < images; ++i) share.update(scale);
    return share.share();
}

TEST(DrawnShare, ShrinksAtOnceAndGrowsAfterAWhile) {
    DrawnShare share;
    EXPECT_EQ(after(share, 1, DrawnShare::kPatience - 1), 0.5);
    EXPECT_EQ(after(share, 1, 1), 1) << "over several steps";
    EXPECT_EQ(share.update(0.7), 0.625) << "all rays of the next smaller rectangle";
    EXPECT_EQ(share.update(0.3), 0.5) << "no smaller one";
    EXPECT_EQ(after(share, 0.8, DrawnShare::kPatience), 0.75);
}

TEST(DrawnShare, DoesNotFlicker) {
    DrawnShare share;
    after(share, 0.76, DrawnShare::kPatience);
    uint32_t changes = 0;
    for (uint32_t i = 0; i < 20 * DrawnShare::kPatience; ++i) {
        const double before = share.share();
        changes += share.update(i % 10 == 0 ? 0.74 : 0.9) != before;
    }
    EXPECT_EQ(changes, 1u) << "it stays at what there is always time for";
    EXPECT_EQ(share.share(), 0.625);
}

TEST(DrawnShare, GrowsToWhatThereWasTimeForInAllImages) {
    DrawnShare share;
    after(share, 1, DrawnShare::kPatience / 2);
    EXPECT_EQ(after(share, 0.8, DrawnShare::kPatience / 2), 0.75);
}

}  // namespace
}  // namespace neuvv::headset
