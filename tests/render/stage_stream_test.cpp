// Streams from a slow server on a stage: what comes in time is shown, and the rest when the clock stands.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "base/trace_file.h"
#include "render/clips/stage_clips.h"
#include "render/frame/frame_renderer.h"
#include "stream/served_stream.h"
#include "support/gpu_test.h"
#include "support/look_at.h"
#include "support/stage_on_disk.h"
#include "voctree/files/clip.h"

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
    double now_s = 0;
    // Follows the stage at times that `next` gives until `done`; false after a minute. Each step takes 2 ms of its
    // clock, however busy the machine is: of a frame that stands for a quarter of a second, all is wanted.
    bool follow(render::StageClips& clips, const std::function<double()>& next, const std::function<bool()>& done) {
        for (int i = 0; i < 30'000 && !done(); ++i) {
            clips.follow(*stage, stage::stage_at(*stage, next()), render::MissingSegments::kHold, now_s += 0.002);
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
    clips.follow(*stage, at_2, render::MissingSegments::kHold, now_s);
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

TEST_F(StageStreamTest, AnEditFindsWhatCameInTime) {
    render::StageLoader loader(device());
    render::StageClips clips(loader.load(*stage));
    const auto& frames = clips.clips()[0].segments;
    uint32_t asked = 0;
    ASSERT_TRUE(follow(
        clips, [&] { return (asked++ / 20 % kFrames) / 25.0; }, [&] { return frames[2].coarse && !frames[2].loaded; }));
    render::StageClips edited(loader.load(*stage));
    EXPECT_EQ(edited.clips()[0].segments[2].coarse, frames[2].coarse);
    EXPECT_EQ(std::ranges::count(edited.fields(), &frames[2].coarse->field), 1);
}

// A frame is shown for a 25th of a second, and here comes after one: those of which the time is over by then are not
// asked for.
TEST_F(StageStreamTest, FramesThatWouldComeTooLateAreLeftOut) {
    const render::StageAssets assets = render::StageLoader(device()).load(*stage);
    render::StageClips clips(assets);
    assets.files->pace_of(clips.clips()[0].index.segments[0])->learn_arrival(1);
    const auto is_there = [&](uint32_t frame) {
        return clips.clips()[0].segments[frame].loaded || clips.clips()[0].segments[frame].coarse;
    };
    double time_s = 0;
    for (int i = 0; i < 2; ++i) {  // nobody is there to see it, but the clock goes on
        stage::EvaluatedStage evaluated = stage::stage_at(*stage, time_s += 1e-6);
        evaluated.performers[0].visible = false;
        clips.follow(*stage, evaluated, render::MissingSegments::kHold, now_s);
    }
    const auto within_the_first = [&] { return time_s += 1e-6; };
    ASSERT_TRUE(follow(clips, within_the_first, [&] { return is_there(2) || is_there(3); }));
    EXPECT_FALSE(is_there(1)) << "it was asked for first, and the server is slow";
}

// Whoever renders waits for all of it.
TEST_F(StageStreamTest, ImagesThatNobodyWaitsForHaveAllOfAFrame) {
    render::StageClips clips(render::StageLoader(device()).load(*stage));
    for (uint32_t frame = 0; frame < kFrames; ++frame) {
        const stage::EvaluatedStage evaluated = stage::stage_at(*stage, frame / 25.0);
        clips.follow(*stage, evaluated, render::MissingSegments::kWait);
        clips.read_missing(evaluated);
        clips.free_dropped();
        ASSERT_TRUE(clips.clips()[0].segments[frame].loaded) << frame;
        EXPECT_EQ(clips.places_of(evaluated.performers[0])[0].field, &clips.clips()[0].segments[frame].loaded->field);
    }
}

TEST_F(StageStreamTest, OfAFrameNothingIsFoundThatNobodyAsksFor) {
    const auto plain = render::StageLoader(device()).load(*stage).clips[0].first;
    EXPECT_FALSE(plain->solid);
    EXPECT_EQ(plain->painted, voctree::PaintedField{}) << "a stream cannot be painted";
    const auto with_solid = render::StageLoader(device(), {}, render::SolidParts::kYes).load(*stage).clips[0].first;
    ASSERT_TRUE(with_solid->solid);
    const auto [low, high] = with_solid->solid->box_at(0);
    EXPECT_TRUE(glm::all(glm::lessThan(low, high)));
}

// How often the host has waited for the device, in all threads, since begin_trace().
size_t waits_until_now(const std::filesystem::path& file) {
    write_trace(file);
    std::ifstream stream(file);
    const std::string text{std::istreambuf_iterator<char>(stream), {}}, name = "wait for the device";
    size_t waits = 0;
    for (size_t at = text.find(name); at != std::string::npos; at = text.find(name, at + 1)) ++waits;
    return waits;
}

TEST_F(StageStreamTest, AnImageThatShowsAnotherFieldWaitsForTheDeviceNoMoreThanOthers) {
    const stage::Stage local = stage::load_stage(folder.path / "show.gltf");
    const auto& segments = local.clips[0].index->segments;
    std::vector<render::Field> fields;
    for (uint32_t i = 0; i < 2; ++i) fields.push_back(render::upload_segment(device(), segments[i]).field);
    render::FrameRenderer frames(device(), {&fields[0]}, {48, 36});
    const stage::Camera camera = look_at({0.5, 0.5, 3}, {0.5, 0.5, 0.5}, 48, 36, 1);
    render::FrameSettings settings;
    settings.width = 48;
    settings.height = 36;
    settings.mode = render::TraceMode::kPlay;
    settings.instances = {render::Instance{}};
    frames.draw({&camera, 1}, settings);
    begin_trace();
    const auto waits_of_an_image = [&] {
        const size_t before = waits_until_now(folder.path / "trace.json");
        frames.draw({&camera, 1}, settings);
        return waits_until_now(folder.path / "trace.json") - before;
    };
    const size_t usual = waits_of_an_image();
    EXPECT_GT(usual, 0u);
    frames.change_fields({&fields[1]});
    EXPECT_EQ(waits_of_an_image(), usual);
}

}  // namespace
}  // namespace neuvv::test::stage_stream_test
