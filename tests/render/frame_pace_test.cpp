// The pace at which frames of a stream come; ladder_traces.json has more of it.
#include "render/clips/frame_pace.h"

#include <gtest/gtest.h>

namespace neuvv::test::frame_pace_test {
namespace {

TEST(FramePace, KnowsWhenAFrameWillBeThere) {
    render::FramePace pace(2);
    int there = 0;
    for (int i = 0; i < 400; ++i) {
        const double seconds = 0.1 + 0.05 * ((i * 7) % 11) / 10;
        if (i >= 200) there += pace.lead_s() >= seconds ? 1 : 0;
        pace.learn_arrival(seconds);
    }
    EXPECT_GT(there, 180);
    EXPECT_LT(pace.lead_s(), 0.2);
}

}  // namespace
}  // namespace neuvv::test::frame_pace_test
