// Where on a time line a performer's sound is loud.
#include "stage/sound/heard_peaks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace neuvv::test::heard_peaks_test {
namespace {

constexpr uint32_t kFrames = 50;  // two seconds
constexpr double kFps = 25, kColumn_s = 0.05;

stage::Timeline timeline(const std::string& map) {
    return stage::timeline_of(stage::parse_time_map(map, "", ""), kFrames, kFps, "", "");
}

// A sound of two seconds that is silent but for the quarter of a second from 0.5 s on.
const media::SoundPeaks& sound() {
    static const media::SoundPeaks made = [] {
        media::Sound one;
        one.samples.resize(2 * media::kSoundRate);
        for (size_t i = media::kSoundRate / 2; i < 3 * media::kSoundRate / 4; ++i)
            one.samples[i] = {i % 2 == 0 ? int16_t{16384} : int16_t{-16384}, 0};
        return media::peaks_of(one);
    }();
    return made;
}

// The first and the last time at which the columns from 0 s on have a peak, in pairs.
std::vector<double> loud_times(const std::string& map, double seconds = 4) {
    std::vector<float> columns(static_cast<size_t>(std::lround(seconds / kColumn_s)));
    stage::heard_peaks(sound(), timeline(map), 0, kColumn_s, columns);
    std::vector<double> times;
    float before = 0;
    columns.push_back(0);
    for (size_t i = 0; i < columns.size(); ++i) {
        EXPECT_TRUE(columns[i] == 0 || columns[i] == 0.5f) << map << " has a column of " << columns[i];
        if (columns[i] != before) times.push_back(std::round(1000 * static_cast<double>(i) * kColumn_s) / 1000);
        before = columns[i];
    }
    return times;
}

using Times = std::vector<double>;

TEST(HeardPeaks, StandWhereTheyAreHeard) {
    EXPECT_EQ(loud_times(""), (Times{0.5, 0.75}));
    EXPECT_EQ(loud_times("offset:1s"), (Times{1.5, 1.75}));
    EXPECT_EQ(loud_times("offset:-0.5s"), (Times{0, 0.25}));
    EXPECT_EQ(loud_times("speed:2.5"), (Times{0.2, 0.3}));
    EXPECT_EQ(loud_times("speed:0.5"), (Times{1, 1.5}));
    EXPECT_EQ(loud_times("clip:0.25s:1s"), (Times{0.25, 0.5}));
    EXPECT_EQ(loud_times("jump:0:0.25s"), (Times{0.25, 0.5}));
}

// Backwards, the clip begins at the beginning of its last frame, which is 0.04 s before its end.
TEST(HeardPeaks, StandWhereTheyAreHeardBackwards) {
    std::vector<float> columns(200);
    stage::heard_peaks(sound(), timeline("reverse"), 0, 0.01, columns);
    for (size_t i = 0; i < columns.size(); ++i) {
        const bool loud = i >= 121 && i < 146;  // 2 − 0.04 − 0.75 s up to 2 − 0.04 − 0.5 s
        EXPECT_EQ(columns[i], loud ? 0.5f : 0.0f) << i;
    }
}

TEST(HeardPeaks, AreRepeatedAsTheClipIs) {
    EXPECT_EQ(loud_times("loop"), (Times{0.5, 0.75, 2.5, 2.75}));
    EXPECT_EQ(loud_times("clip:0.4s:1s,loop", 1.3), (Times{0.1, 0.35, 0.7, 0.95}));
    // There and back takes 1.2 s: the part without its last frame, two times.
    EXPECT_EQ(loud_times("ping-pong:0.4s:1.04s", 2), (Times{0.1, 0.35, 0.85, 1.1, 1.3, 1.55}));
}

TEST(HeardPeaks, AreNotHeardWhereTheClipStands) {
    EXPECT_EQ(loud_times("freeze:0.6s"), Times{});
    EXPECT_EQ(loud_times("pause:0.6s:1s"), (Times{0.5, 0.6, 1.6, 1.75}));
    EXPECT_EQ(loud_times("clip:0.5s:0.6s"), (Times{0, 0.1})) << "the last frame then stands";
    EXPECT_EQ(loud_times("clip:0.55s:0.7s,speed:0.1"), (Times{0, 1.5}));
    EXPECT_EQ(loud_times("clip:0.55s:0.7s,speed:0.01,speed:0.01"), Times{}) << "so slow is as good as standing";
    EXPECT_EQ(loud_times("speed:500"), Times{});
}

TEST(HeardPeaks, AColumnHasTheLoudestOfAllItsTimes) {
    std::vector<float> columns(2);
    stage::heard_peaks(sound(), timeline(""), -1, 2, columns);
    EXPECT_EQ(columns, (std::vector<float>{0.5f, 0}));
    stage::heard_peaks(sound(), timeline("loop:0.4s:0.6s"), 100, 2, columns);
    EXPECT_EQ(columns, (std::vector<float>{0.5f, 0.5f})) << "ten repetitions a column";
    stage::heard_peaks(sound(), timeline("ping-pong"), 1e6, 60, columns);
    EXPECT_EQ(columns, (std::vector<float>{0.5f, 0.5f}));
}

// What clip_position goes through, in small steps, is exactly what the parts cover.
void expect_as_played(const std::string& map, double from_s, double to_s) {
    SCOPED_TRACE(map + " from " + std::to_string(from_s) + " to " + std::to_string(to_s));
    const stage::Timeline one = timeline(map);
    std::vector<stage::ClipPart> parts;
    stage::heard_parts(one, from_s, to_s, parts);
    constexpr int kSteps = 20'000;
    const double step_s = (to_s - from_s) / kSteps;
    constexpr double kNear = 1e-3, kCell = 0.1;  // frames
    std::vector<bool> played(static_cast<size_t>(kFrames / kCell) + 1), covered(played.size());
    for (int i = 0; i + 1 < kSteps; ++i) {
        const double here = stage::clip_position(one, from_s + i * step_s);
        const double next = stage::clip_position(one, from_s + (i + 1) * step_s);
        if (std::abs(next - here) < 1e-7 || std::abs(next - here) > 1) continue;  // it stands, or jumps
        const double at = (here + next) / 2;
        played[static_cast<size_t>(at / kCell)] = true;
        EXPECT_TRUE(
            std::any_of(parts.begin(), parts.end(),
                        [&](const stage::ClipPart& part) { return at > part.begin - kNear && at < part.end + kNear; }))
            << "frame " << at << " is heard at " << from_s + i * step_s;
    }
    for (const stage::ClipPart& part : parts)
        for (double at = part.begin + kCell; at < part.end - kCell; at += kCell / 2)
            EXPECT_TRUE(played[static_cast<size_t>(at / kCell)]) << "frame " << at << " is not heard";
}

TEST(HeardPeaks, PartsAreThoseThatArePlayed) {
    for (const char* map :
         {"", "offset:3f", "offset:-3f", "reverse", "speed:2", "pause:10f:1s", "jump:20f:5f", "jump:5f:20f", "loop",
          "ping-pong", "loop:10f:20f", "ping-pong:10f:20f", "clip:10f:30f,loop,speed:0.5,offset:7f", "reverse,loop",
          "loop:5f:45f,loop:3f:100f,loop:2f:90f", "ping-pong:5f:45f,loop:3f:100f", "speed:2,reverse,pause:7f:3f,loop",
          "jump:30f:10f,jump:20f:15f,offset:-2f,hold", "clip:10f:30f,reverse,ping-pong,offset:1s"})
        for (const auto& [from_s, to_s] : {std::pair{-1.0, 6.0}, {0.3, 0.9}, {1.1, 1.2}, {1.9, 2.3}, {3.1, 3.13}})
            expect_as_played(map, from_s, to_s);
}

// However many operators a map has, the parts stay few.
TEST(HeardPeaks, PartsStayFew) {
    std::string map = "loop:1f:49f";
    for (int i = 2; i < 60; ++i) map += ",loop:" + std::to_string(i % 7) + "f:" + std::to_string(40 + i % 11) + "f";
    std::vector<stage::ClipPart> parts;
    std::mt19937 random(5);
    for (int i = 0; i < 200; ++i) {
        const double from_s = std::uniform_real_distribution(0.0, 1000.0)(random);
        stage::heard_parts(timeline(map), from_s, from_s + 1.3, parts);
        EXPECT_FALSE(parts.empty());
        EXPECT_LE(parts.size(), stage::kMaxTimeOperators + 1);
        for (size_t j = 1; j < parts.size(); ++j) EXPECT_LT(parts[j - 1].end, parts[j].begin) << "they are apart";
    }
}

}  // namespace
}  // namespace neuvv::test::heard_peaks_test
