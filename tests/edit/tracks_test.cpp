#include "edit/tracks.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"

namespace neuvv {
namespace {

stage::TimeMap map_of(const std::string& text) {
    return stage::parse_time_map(text, "test", "time");
}

// Three performers of one clip of 50 frames at 25 fps, one of another clip; one more performer is in no scene.
stage::StageFile some_stage() {
    return stage::make_stage_file("/nowhere/stage.gltf", R"({"asset": {"version": "2.0"}, "scene": 0,
        "extensionsUsed": ["NEUVV_performer"],
        "scenes": [{"nodes": [0, 1, 5]}], "nodes": [
        {"name": "floor"},
        {"name": "group", "children": [2, 3]},
        {"name": "anna", "extensions": {"NEUVV_performer": {"uri": "a.nvv"}}},
        {"extensions": {"NEUVV_performer": {"uri": "a.nvv", "time": [{"operator": "offset", "by": "1s"}]}}},
        {"name": "away", "extensions": {"NEUVV_performer": {"uri": "a.nvv"}}},
        {"name": "bert", "children": [6], "extensions": {"NEUVV_performer": {"uri": "./a.nvv",
            "sound": {"uri": "song.wav", "gain": -6}}}},
        {"name": "carl", "extensions": {"NEUVV_performer": {"uri": "b.nvv"}}}]})");
}

std::vector<stage::StageClip> some_clips() {
    stage::StageClip clip;
    clip.path = stage::absolute_path("/nowhere/a.nvv");
    clip.frames = 50;
    clip.fps = 25;
    return {clip};
}

TEST(TimelineTracks, AreThoseOfTheSceneWhoseClipIsKnown) {
    std::vector<stage::StageClip> clips = some_clips();
    std::vector<edit::PerformerTrack> tracks = edit::performer_tracks(some_stage(), clips);
    ASSERT_EQ(tracks.size(), 3u);
    EXPECT_EQ(tracks[0].name, "anna");
    EXPECT_EQ(tracks[0].bar.start_s, 0);
    EXPECT_EQ(tracks[0].bar.end_s, 2);
    EXPECT_EQ(tracks[1].name, "node 3");
    EXPECT_EQ(tracks[1].node, 3u);
    EXPECT_EQ(tracks[1].bar.start_s, 1);
    EXPECT_EQ(stage::frame_at(tracks[1].timeline, 1.4), 10);
    EXPECT_EQ(tracks[2].name, "bert");
    EXPECT_EQ(tracks[2].sound, stage::absolute_path("/nowhere/song.wav"));
    EXPECT_EQ(tracks[2].gain_db, -6);
    EXPECT_TRUE(tracks[0].sound.empty());
    clips.push_back(clips[0]);
    clips[1].path = stage::absolute_path("/nowhere/b.nvv");
    EXPECT_EQ(edit::performer_tracks(some_stage(), clips).size(), 4u);
    EXPECT_TRUE(
        edit::performer_tracks(stage::make_stage_file("/nowhere/empty.gltf", R"({"asset": {"version": "2.0"}})"), clips)
            .empty());
}

TEST(TimelineTracks, EditsChangeTheMapOfOneNode) {
    stage::StageFile file = some_stage();
    edit::edit_time(file, 3, [](const stage::TimeMap& map) { return edit::moved(map, {50, 25}, 0.4); });
    const std::vector<edit::PerformerTrack> tracks = edit::performer_tracks(file, some_clips());
    EXPECT_NEAR(tracks[1].bar.start_s, 1.4, 1e-9);
    EXPECT_EQ(tracks[0].bar.start_s, 0);
    EXPECT_THROW(edit::edit_time(file, 0, [](const stage::TimeMap& map) { return map; }), InputError) << "a floor";
}

TEST(TimelineTracks, StaggerFollowsWhoIsDragged) {
    const auto starts = [](uint32_t node, double by_s) {
        stage::StageFile file = some_stage();
        edit::stagger_together(file, some_clips(), node, by_s);
        std::vector<double> seconds;
        for (const edit::PerformerTrack& track : edit::performer_tracks(file, some_clips()))
            seconds.push_back(track.bar.start_s);
        return seconds;
    };
    const std::vector<double> last = starts(5, 1), first = starts(2, 0.2);
    EXPECT_NEAR(last[0], 0, 1e-9);
    EXPECT_NEAR(last[1], 1.5, 1e-9) << "half a second later than it was";
    EXPECT_NEAR(last[2], 1, 1e-9);
    EXPECT_NEAR(first[0], 0.2, 1e-9);
    EXPECT_NEAR(first[1], 1.4, 1e-9);
    EXPECT_NEAR(first[2], 0.6, 1e-9);
    stage::StageFile file = some_stage();
    EXPECT_THROW(edit::stagger_together(file, some_clips(), 6, 1), InputError);
}

TEST(TimelineTracks, SpeedAndDirectionAreOfAllOperators) {
    EXPECT_DOUBLE_EQ(edit::speed_of(map_of("speed:2,clip:0s:1s,speed:0.25")), 0.5);
    EXPECT_EQ(edit::speed_of({}), 1);
    EXPECT_TRUE(edit::is_reversed(map_of("reverse,offset:1s")));
    EXPECT_FALSE(edit::is_reversed(map_of("reverse,clip:0s:1s,reverse")));
}

TEST(TimelineTracks, RepeatsWhatWasShownUntilItDoesNoMore) {
    EXPECT_EQ(edit::repeat_of(map_of("offset:1s")), edit::Repeat::kOnce);
    const stage::TimeMap loop = edit::repeated(map_of("clip:0s:1s,offset:1s,hold"), edit::Repeat::kLoop);
    EXPECT_EQ(stage::text_of(loop), "clip:0s:1s,loop,offset:1s,hold");
    EXPECT_EQ(edit::repeat_of(loop), edit::Repeat::kLoop);
    const stage::TimeMap there_and_back = edit::repeated(loop, edit::Repeat::kPingPong);
    EXPECT_EQ(stage::text_of(there_and_back), "clip:0s:1s,ping-pong,offset:1s,hold");
    EXPECT_EQ(stage::text_of(edit::repeated(there_and_back, edit::Repeat::kOnce)), "clip:0s:1s,offset:1s,hold");
    EXPECT_EQ(stage::text_of(edit::repeated(map_of("loop:1s:2s"), edit::Repeat::kOnce)), "clip:1s:2s")
        << "its part stays";
    EXPECT_EQ(stage::text_of(edit::repeated(map_of("loop"), edit::Repeat::kOnce)), "");
    EXPECT_TRUE(edit::repeated({}, edit::Repeat::kOnce).empty());
}

TEST(TimelineTracks, HoldsAndFreezesWhatIsShown) {
    const edit::ClipRate clip{50, 25};
    const auto frame = [&](const stage::TimeMap& map, double stage_s) {
        return stage::frame_at(stage::timeline_of(map, clip.frames, clip.fps, "test", "time"), stage_s);
    };
    for (const char* text : {"", "offset:1s", "offset:10f,hold", "offset:-5f", "speed:2,offset:0.4s"}) {
        const stage::TimeMap map = map_of(text), paused = edit::paused_at(map, clip, 1.2, 0.6),
                             frozen = edit::frozen_at(map, clip, 1.2);
        EXPECT_EQ(frame(paused, 1), frame(map, 1)) << text;
        for (const double later_s : {0.0, 0.3, 0.6}) EXPECT_EQ(frame(paused, 1.2 + later_s), frame(map, 1.2)) << text;
        EXPECT_EQ(frame(paused, 2), frame(map, 1.4)) << text;
        for (const double stage_s : {0.0, 1.2, 5.0}) EXPECT_EQ(frame(frozen, stage_s), frame(map, 1.2)) << text;
        EXPECT_TRUE(edit::is_frozen(frozen));
        EXPECT_FALSE(edit::is_frozen(paused));
        EXPECT_EQ(edit::unfrozen(frozen), map) << text;
    }
}

}  // namespace
}  // namespace neuvv
