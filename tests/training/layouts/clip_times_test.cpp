// Frames of several videos by their times.
#include "training/data/layouts/rig/clip_times.h"

#include <gtest/gtest.h>

#include <numeric>

#include "support/input_error.h"

namespace neuvv {
namespace {

using training::ClipTimes;
using training::ClipVideo;
using training::kNotInClip;

// A video of `count` frames at this rate from `start_s` on, without those of the numbers in `dropped`.
ClipVideo video(const char* name, double fps, int count, double start_s = 0, const std::vector<int>& dropped = {}) {
    ClipVideo result{name, std::string(name) + ".mp4", {{}, fps, {}}};
    for (int i = 0; i < count; ++i)
        if (std::ranges::find(dropped, i) == dropped.end()) result.times.shown_s.push_back(start_s + i / fps);
    return result;
}

std::vector<int64_t> counted(int64_t count, int64_t first = 0) {
    std::vector<int64_t> numbers(static_cast<size_t>(count));
    std::iota(numbers.begin(), numbers.end(), first);
    return numbers;
}

std::string said(const ClipTimes& clip) {
    std::string text;
    for (const auto& [name, what] : clip.texts) text.append(name).append(": ").append(what).append("\n");
    for (const std::string& remark : clip.remarks) text += remark + "\n";
    return text;
}

TEST(ClipTimes, OfLikeVideosAreTheirNumbers) {
    const ClipTimes clip = training::clip_times({video("a", 25, 6), video("b", 25, 6)});
    EXPECT_EQ(clip.fps, 25);
    EXPECT_EQ(clip.frames, (std::vector{counted(6), counted(6)}));
    EXPECT_EQ(said(clip), "");
}

TEST(ClipTimes, DroppedFramesAreGapsWithNames) {
    const ClipTimes clip = training::clip_times({video("a", 25, 10), video("b", 25, 10, 0, {2, 5, 6, 7})});
    EXPECT_EQ(clip.frames[1], (std::vector<int64_t>{0, 1, 3, 4, 8, 9}));
    EXPECT_EQ(said(clip), "b: no image at frames 2, 5 to 7\n");
}

TEST(ClipTimes, WhereNoCameraHasAnImageTheClipJumps) {
    const ClipTimes clip =
        training::clip_times({video("a", 25, 20, 0, {3, 12, 13, 14, 17}), video("b", 25, 20, 0, {12, 13, 14, 17, 18})});
    EXPECT_EQ(clip.frames[0].back(), 19);
    EXPECT_EQ(said(clip),
              "a: no image at frame 3\nb: no image at frame 18\n"
              "no camera has an image at 0.48 s (frames 12 to 14), 0.68 s (frame 17): the clip jumps there\n");
    const ClipTimes often = training::clip_times({video("a", 25, 41, 0, {1, 5, 9, 13, 17, 21, 25, 29, 33, 37})});
    EXPECT_NE(said(often).find("1.16 s (frame 29) and at 2 more times: the clip"), std::string::npos) << said(often);
}

TEST(ClipTimes, TheRateIsThatOfMostAndOfEquallyManyTheLower) {
    const ClipTimes tie = training::clip_times({video("a", 25, 10), video("b", 50, 20)});
    EXPECT_EQ(tie.fps, 25);
    EXPECT_EQ(tie.frames[0], counted(10));
    for (size_t i = 0; i < 20; ++i) EXPECT_EQ(tie.frames[1][i], i % 2 == 0 ? int64_t(i / 2) : kNotInClip);
    EXPECT_EQ(said(tie), "b: 50 frames a second, in a clip of 25, for which the images between are left out\n");
    const ClipTimes most = training::clip_times({video("a", 25, 5), video("b", 50, 9), video("c", 50, 9)});
    EXPECT_EQ(most.fps, 50);
    EXPECT_EQ(most.frames[0], (std::vector<int64_t>{0, 2, 4, 6, 8}));
    EXPECT_EQ(most.frames[1], counted(9));
    EXPECT_EQ(said(most), "a: 25 frames a second, in a clip of 50\na: no image at frames 1, 3, 5, 7\n");
    const ClipTimes ntsc = training::clip_times({video("a", 30000.0 / 1001, 9), video("b", 30, 9)});
    EXPECT_EQ(ntsc.frames, (std::vector{counted(9), counted(9)})) << "after 0.3 s they are one";
}

// 60 frames a second beside 25: each moment has the nearest image, and no image is taken twice.
TEST(ClipTimes, RatesWithoutACommonMeasure) {
    const ClipTimes clip = training::clip_times({video("a", 25, 10), video("b", 60, 24), video("c", 25, 10)});
    std::vector<int64_t> taken;
    for (size_t i = 0; i < 24; ++i) {
        if (clip.frames[1][i] == kNotInClip) continue;
        taken.push_back(clip.frames[1][i]);
        EXPECT_LE(std::abs(static_cast<double>(i) / 60 - static_cast<double>(taken.back()) / 25), 0.5 / 60 + 1e-4);
    }
    EXPECT_EQ(taken, counted(10));
}

TEST(ClipTimes, JitterOfPhonesDoesNoHarm) {
    ClipVideo phone = video("b", 30, 12);
    for (size_t i = 0; i < phone.times.shown_s.size(); ++i) phone.times.shown_s[i] += (i % 3 == 1 ? 0.012 : -0.009);
    const ClipTimes clip = training::clip_times({video("a", 30, 12), phone});
    EXPECT_EQ(clip.frames[1], counted(12));
}

TEST(ClipTimes, VideosThatBeginLater) {
    const ClipTimes clip =
        training::clip_times({video("a", 25, 10), video("b", 25, 8, 0.08), video("c", 25, 10, 0.004)});
    EXPECT_EQ(clip.frames[1], counted(8, 2));
    EXPECT_EQ(said(clip), "b: no image at frames 0, 1\n");
}

TEST(ClipTimes, TimecodesOfAllAreTheClock) {
    std::vector<ClipVideo> videos = {video("a", 25, 10), video("b", 25, 10), video("c", 25, 10)};
    videos[0].times.timecode_s = 86399.96;
    videos[1].times.timecode_s = 0;  // a frame later, after midnight
    EXPECT_EQ(training::clip_times(videos).frames[1], counted(10)) << "one has no timecode";
    EXPECT_NE(said(training::clip_times(videos)).find("timecode not used"), std::string::npos);
    videos[2].times.timecode_s = 86399.96;
    const ClipTimes clip = training::clip_times(videos);
    EXPECT_EQ(clip.frames[0], counted(10));
    std::vector<int64_t> later = counted(10, 1);
    later.back() = kNotInClip;  // that only one shows
    EXPECT_EQ(clip.frames[1], later);
    EXPECT_NE(said(clip).find("by their timecodes"), std::string::npos);
    EXPECT_NE(said(clip).find("left out: frame 10,"), std::string::npos) << said(clip);
    videos[0].times.timecode_s = 100;
    videos[1].times.timecode_s = 200;
    videos[2].times.timecode_s = 300;
    expect_input_error([&] { training::clip_times(videos); }, {"a.mp4", "timecodes", "c at 200.00 s", "-write_tmcd 0"});
}

TEST(ClipTimes, EndsThatFewVideosShowAreLeftOut) {
    const ClipTimes clip = training::clip_times({video("a", 25, 12), video("b", 25, 5, 0.16), video("c", 25, 6, 0.12)});
    EXPECT_EQ(clip.frames[0], (std::vector<int64_t>{-1, -1, -1, 3, 4, 5, 6, 7, 8, -1, -1, -1}));
    EXPECT_NE(said(clip).find("left out: frames 0 to 2, 9 to 11,"), std::string::npos) << said(clip);
}

}  // namespace
}  // namespace neuvv
