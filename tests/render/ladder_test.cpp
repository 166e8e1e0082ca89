// The choice of how many parts of a stream are taken.
#include "render/clips/ladder.h"

#include <gtest/gtest.h>

namespace neuvv::test::ladder_test {
namespace {

// 10 frames in half a second: 10, 30, 40, 60 and 80 KB up to each part.
constexpr stream::GroupCost kGroup{{10'000, 30'000, 40'000, 60'000, 80'000}, 10, 0.5};

TEST(Ladder, TakesAllOfAFile) {
    EXPECT_EQ(render::Ladder().choose(kGroup, std::nullopt), stream::kShFine);
}

TEST(Ladder, TakesWhatAServerSendsInTime) {
    const render::Ladder ladder;
    EXPECT_EQ(ladder.choose(kGroup, 80'000 / 0.5 / 0.8), stream::kShFine);
    EXPECT_EQ(ladder.choose(kGroup, 79'000 / 0.5 / 0.8), stream::kFine);
    EXPECT_EQ(ladder.choose(kGroup, 59'000 / 0.5 / 0.8), stream::kShCoarse);
    EXPECT_EQ(ladder.choose(kGroup, 39'000 / 0.5 / 0.8), stream::kCoarse);
    EXPECT_EQ(ladder.choose(kGroup, 1), stream::kCoarse) << "something is shown, late or not";
    EXPECT_EQ(ladder.choose(kGroup, 0), stream::kCoarse) << "nobody knows yet";
}

TEST(Ladder, TakesWhatIsDecodedInTime) {
    render::Ladder ladder;
    for (int i = 0; i < 200; ++i) ladder.learn_planes(1000, 1e-6);
    EXPECT_EQ(ladder.choose(kGroup, std::nullopt), stream::kShFine);
    // Up to kShCoarse, planes take 4 s; even 8 frames at once leave 3.2 s for them.
    for (int i = 0; i < 200; ++i) ladder.learn_planes(1000, 0.1);
    EXPECT_EQ(ladder.choose(kGroup, std::nullopt), stream::kCoarse);
    for (int i = 0; i < 200; ++i) ladder.learn_planes(1000, 1e-6);
    EXPECT_EQ(ladder.choose(kGroup, std::nullopt), stream::kShFine) << "what is old is forgotten";
    // A frame that only repeats has few bytes, and takes a while all the same.
    for (int i = 0; i < 200; ++i) ladder.learn_planes(20'000, 0.002);
    ladder.learn_planes(100, 0.003);
    EXPECT_EQ(ladder.choose(kGroup, std::nullopt), stream::kShFine);
}

// 80 KB of planes take 0.1 s. Where the rest of each frame leaves no time for that, fewer of them are taken.
TEST(Ladder, CountsWhatIsDoneBehindTheDecoder) {
    render::Ladder ladder;
    ladder.learn_planes(80'000, 0.1);
    EXPECT_EQ(ladder.choose(kGroup, std::nullopt), stream::kShFine);
    const double time_s = stream::frames_at_once() * 0.5 * 0.8;
    for (const render::FrameStep step : {render::FrameStep::kShape, render::FrameStep::kUpload})
        ladder.learn_step(step, (time_s - 0.09) / 10 / 2);
    EXPECT_EQ(ladder.choose(kGroup, std::nullopt), stream::kFine);
    for (int i = 0; i < 100; ++i) ladder.learn_step(render::FrameStep::kUpload, time_s);
    EXPECT_EQ(ladder.choose(kGroup, std::nullopt), stream::kCoarse);
}

}  // namespace
}  // namespace neuvv::test::ladder_test
