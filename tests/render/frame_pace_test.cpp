// The pace at which frames of a stream come.
#include "render/clips/frame_pace.h"

#include <gtest/gtest.h>

namespace neuvv::test::frame_pace_test {
namespace {

TEST(FramePace, KnowsWhenAFrameWillBeThere) {
    render::FramePace pace;
    EXPECT_EQ(pace.lead_s(), 0) << "nobody knows yet";
    for (int i = 0; i < 100; ++i) pace.learn_arrival(0.1);
    EXPECT_NEAR(pace.lead_s(), 0.1, 1e-3);
    int there = 0;
    for (int i = 0; i < 400; ++i) {
        const double seconds = 0.1 + 0.05 * ((i * 7) % 11) / 10;
        if (i >= 200) there += pace.lead_s() >= seconds ? 1 : 0;
        pace.learn_arrival(seconds);
    }
    EXPECT_GT(there, 180);
    EXPECT_LT(pace.lead_s(), 0.2);
    for (int i = 0; i < 100; ++i) pace.learn_arrival(30);
    EXPECT_EQ(pace.lead_s(), render::FramePace::kMostLead_s);
}

TEST(FramePace, ChoosesTheSamePartsForAGroupForAWhile) {
    const stream::GroupCost first{{10'000, 30'000, 40'000, 60'000, 80'000}, 10, 0.5, 0};
    stream::GroupCost second = first;
    second.number = 1;
    render::FramePace pace;
    ASSERT_EQ(pace.part_in_time(first, {}), stream::kShFine);
    render::SegmentTimes slow;
    slow.upload_s = 100;
    for (int i = 0; i < 100; ++i) pace.learn(slow);
    EXPECT_EQ(pace.part_in_time(first, {}), stream::kShFine) << "part of the way through a group, nothing changes";
    EXPECT_EQ(pace.part_in_time(second, {}), stream::kCoarse);
}

}  // namespace
}  // namespace neuvv::test::frame_pace_test
