// The choice of how many parts of a stream are taken.
#include "stream/ladder.h"

#include <gtest/gtest.h>

namespace neuvv::test::ladder_test {
namespace {

// Half a second: 10, 30, 40, 60 and 80 KB up to each part.
constexpr stream::GroupCost kGroup{{10'000, 30'000, 40'000, 60'000, 80'000}, 0.5};

TEST(Ladder, TakesAllOfAFile) {
    EXPECT_EQ(stream::Ladder().choose(kGroup, std::nullopt), stream::kShFine);
}

TEST(Ladder, TakesWhatAServerSendsInTime) {
    const stream::Ladder ladder;
    EXPECT_EQ(ladder.choose(kGroup, 80'000 / 0.5 / 0.8), stream::kShFine);
    EXPECT_EQ(ladder.choose(kGroup, 79'000 / 0.5 / 0.8), stream::kFine);
    EXPECT_EQ(ladder.choose(kGroup, 59'000 / 0.5 / 0.8), stream::kShCoarse);
    EXPECT_EQ(ladder.choose(kGroup, 39'000 / 0.5 / 0.8), stream::kCoarse);
    EXPECT_EQ(ladder.choose(kGroup, 1), stream::kCoarse) << "something is shown, late or not";
    EXPECT_EQ(ladder.choose(kGroup, 0), stream::kCoarse) << "nobody knows yet";
}

TEST(Ladder, TakesWhatIsDecodedInTime) {
    stream::Ladder ladder;
    for (int i = 0; i < 200; i++) ladder.learn(1000, 1e-6);
    EXPECT_EQ(ladder.choose(kGroup, std::nullopt), stream::kShFine);
    // At most 4 frames at once: 60 KB take 6 s and more.
    for (int i = 0; i < 200; i++) ladder.learn(1000, 0.1);
    EXPECT_EQ(ladder.choose(kGroup, std::nullopt), stream::kCoarse);
    for (int i = 0; i < 200; i++) ladder.learn(1000, 1e-6);
    EXPECT_EQ(ladder.choose(kGroup, std::nullopt), stream::kShFine) << "what is old is forgotten";
    // A frame that only repeats has few bytes, and takes a while all the same.
    for (int i = 0; i < 200; i++) ladder.learn(20'000, 0.002);
    ladder.learn(100, 0.003);
    EXPECT_EQ(ladder.choose(kGroup, std::nullopt), stream::kShFine);
}

}  // namespace
}  // namespace neuvv::test::ladder_test
