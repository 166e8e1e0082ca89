// Streams from a slow server on a stage: what comes in time is shown, and the rest when the clock stands.
#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "render/stage_clips.h"
#include "stream/served_stream.h"
#include "support/gpu_test.h"
#include "support/stage_on_disk.h"

namespace neuvv::test::stage_stream_test {
namespace {

constexpr uint32_t kFrames = 4;

struct StageStreamTest : GpuTest, ServedStream {
    std::unique_ptr<stage::Stage> stage;

    void SetUp() override {
        GpuTest::SetUp();
        start(kFrames);
        write_stage(folder.path / "show.gltf", file, "anna");
        stage = std::make_unique<stage::Stage>(stage::load_stage(folder.path / "show.gltf"));
        // The server sends 200 KB a second, and frames of some 100 KB are shown for a 25th.
        stage->clips[0].path = address("slow");
        stage->clips[0].index =
            std::make_shared<const voctree::ClipIndex>(voctree::read_clip_index(stage->clips[0].path));
    }
    // Follows the stage at times that `next` gives until `done`; false after a minute.
    bool follow(render::StageClips& clips, const std::function<double()>& next, const std::function<bool()>& done) {
        for (int i = 0; i < 30'000 && !done(); i++) {
            clips.follow(*stage, stage::stage_at(*stage, next()), render::MissingSegments::kHold);
            clips.free_dropped();
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
        return done();
    }
};

TEST_F(StageStreamTest, WhatComesInTimeIsShownUntilTheClockStands) {
    render::StageClips clips(render::StageLoader(device()).load(*stage));
    const auto& frames = clips.clips()[0].segments;
    const auto is_partial = [&](uint32_t frame) { return frames[frame].coarse && !frames[frame].loaded; };
    // As a headset asks: several times at each frame of the stage.
    uint32_t asked = 0;
    const auto playing = [&] { return (asked++ / 20 % kFrames) / 25.0; };
    ASSERT_TRUE(follow(clips, playing, [&] { return is_partial(1) && is_partial(2) && is_partial(3); }))
        << "the clock runs";
    const stage::EvaluatedStage at_2 = stage::stage_at(*stage, 2 / 25.0);
    clips.follow(*stage, at_2, render::MissingSegments::kHold);
    ASSERT_EQ(clips.places_of(at_2.performers[0]).size(), 1u);
    EXPECT_EQ(clips.places_of(at_2.performers[0])[0].field, &frames[2].coarse->field);
    EXPECT_FALSE(clips.shows_all(at_2));
    ASSERT_TRUE(follow(
        clips, [] { return 2 / 25.0; }, [&] { return clips.shows_all(at_2); }))
        << "the clock stands";
    ASSERT_TRUE(frames[2].loaded);
    EXPECT_EQ(clips.places_of(at_2.performers[0])[0].field, &frames[2].loaded->field);
    EXPECT_TRUE(clips.problems().empty());
}

// Whoever renders waits for all of it.
TEST_F(StageStreamTest, ImagesThatNobodyWaitsForHaveAllOfAFrame) {
    render::StageClips clips(render::StageLoader(device()).load(*stage));
    for (uint32_t frame = 0; frame < kFrames; frame++) {
        const stage::EvaluatedStage evaluated = stage::stage_at(*stage, frame / 25.0);
        clips.follow(*stage, evaluated, render::MissingSegments::kWait);
        clips.read_missing(evaluated);
        clips.free_dropped();
        ASSERT_TRUE(clips.clips()[0].segments[frame].loaded) << frame;
        EXPECT_EQ(clips.places_of(evaluated.performers[0])[0].field, &clips.clips()[0].segments[frame].loaded->field);
    }
}

}  // namespace
}  // namespace neuvv::test::stage_stream_test
