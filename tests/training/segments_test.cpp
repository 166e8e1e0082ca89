// Cutting a clip into segments.
#include "training/data/segments.h"

#include <gtest/gtest.h>

#include <numeric>

namespace neuvv::test {
namespace {

TEST(SegmentLengths, AreEvenAndCoverAllFrames) {
    for (uint32_t frames = 1; frames <= 40; ++frames)
        for (uint32_t longest = 1; longest <= 45; ++longest) {
            const std::vector<uint32_t> lengths = training::segment_lengths(frames, longest);
            EXPECT_EQ(std::accumulate(lengths.begin(), lengths.end(), 0u), frames);
            const auto [least, most] = std::minmax_element(lengths.begin(), lengths.end());
            EXPECT_LE(*most, longest);
            EXPECT_LE(*most - *least, 1u);
            EXPECT_EQ(lengths.size(), (frames + longest - 1) / longest) << "no more segments than needed";
        }
}

TEST(RigOfFrames, HasTheShotsOfItsFrames) {
    training::Rig rig;
    rig.cameras = {{.name = "a"}, {.name = "late"}, {.name = "c"}};
    const double times[] = {0, 0.25, 0.5, 0.75, 1};
    for (uint32_t camera = 0; camera < 3; ++camera)
        for (const double time : times)
            if (camera != 1 || time > 0.6) rig.shots.push_back({.camera = camera, .time = time});
    const std::vector<double> all = training::times_of(rig);
    EXPECT_EQ(all, std::vector<double>(std::begin(times), std::end(times)));

    const training::Rig centre = training::rig_of_frames(rig, all, 1, 2);
    EXPECT_EQ(training::times_of(centre), (std::vector<double>{0, 1}));
    ASSERT_EQ(centre.cameras.size(), 2u) << "the camera that begins later is left out";
    EXPECT_EQ(centre.cameras[1].name, "c");
    EXPECT_EQ(centre.shots.size(), 4u);
    for (const training::Shot& shot : centre.shots) EXPECT_LT(shot.camera, 2u);

    const training::Rig last = training::rig_of_frames(rig, all, 4, 1);
    EXPECT_EQ(training::times_of(last), std::vector<double>{0});
    EXPECT_EQ(last.cameras.size(), 3u);
    EXPECT_EQ(training::times_of(training::rig_of_frames(rig, all, 0, 5)), all);
}

}  // namespace
}  // namespace neuvv::test
