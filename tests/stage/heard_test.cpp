// What is heard as a clip plays by a time map.
#include "stage/sound/heard.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/wav_file.h"

namespace neuvv::test::heard_test {
namespace {

constexpr uint32_t kFrames = 50;  // two seconds
constexpr double kFps = 25;
constexpr size_t kHop = media::kSoundHop, kRate = media::kSoundRate;

// A tone that becomes louder, so that no two places of it are the same.
const media::Sound& sound() {
    static const media::Sound made = [] {
        media::Sound one;
        const std::vector<int16_t> tone = stereo_tone(2 * kRate);
        for (size_t i = 0; i < 2 * kRate; ++i) {
            const double louder = 0.5 + 0.5 * static_cast<double>(i) / (2 * kRate);
            one.samples.push_back(
                {static_cast<int16_t>(tone[2 * i] * louder), static_cast<int16_t>(tone[2 * i + 1] * louder)});
        }
        return one;
    }();
    return made;
}

// The left side, from a stage time on.
std::vector<float> heard(const std::string& map, double seconds, double begin_s = 0) {
    stage::Heard one(sound(), stage::timeline_of(stage::parse_time_map(map, "", ""), kFrames, kFps, "", ""), begin_s);
    std::vector<float> all;
    while (all.size() < static_cast<size_t>(seconds * kRate)) {
        std::array<media::StereoSample, kHop> samples{};
        one.add_hop(samples, 1);
        for (const media::StereoSample& sample : samples) all.push_back(sample[0]);
    }
    return all;
}

float original(double at) {
    const auto index = static_cast<size_t>(std::lround(at));
    return index < sound().samples.size() ? static_cast<float>(sound().samples[index][0]) / 32768 : 0;
}

float loudest(const std::vector<float>& samples, double from_s, double to_s) {
    float most = 0;
    for (auto i = static_cast<size_t>(from_s * kRate); i < static_cast<size_t>(to_s * kRate); ++i)
        most = std::max(most, std::abs(samples[i]));
    return most;
}

// The largest step from one sample to the next.
float steepest(const std::vector<float>& samples) {
    float most = 0;
    for (size_t i = 1; i < samples.size(); ++i) most = std::max(most, std::abs(samples[i] - samples[i - 1]));
    return most;
}

double pitch_hz(const std::vector<float>& samples, double from_s, double to_s) {
    int crossings = 0;
    for (auto i = static_cast<size_t>(from_s * kRate); i < static_cast<size_t>(to_s * kRate); ++i)
        crossings += samples[i] < 0 && samples[i + 1] >= 0;
    return crossings / (to_s - from_s);
}

TEST(Heard, AClipAsItIsSoundsAsItIs) {
    const std::vector<float> all = heard("", 1.9);
    for (size_t i = 0; i < static_cast<size_t>(1.9 * kRate); ++i) ASSERT_NEAR(all[i], original(double(i)), 1e-5) << i;
    const std::vector<float> later = heard("", 0.5, 1);
    for (size_t i = 0; i < kRate / 2; ++i) ASSERT_NEAR(later[i], original(double(i + kRate)), 1e-5) << i;
}

TEST(Heard, ItFollowsOffsetsLoopsAndReverse) {
    const std::vector<float> late = heard("offset:0.5s", 1);
    EXPECT_EQ(loudest(late, 0, 0.45), 0);
    for (size_t i = kRate * 6 / 10; i < kRate; ++i) ASSERT_NEAR(late[i], original(double(i - kRate / 2)), 1e-5) << i;
    const std::vector<float> loop = heard("loop:0s:1s", 1.9);
    for (size_t i = kRate * 11 / 10; i < kRate * 18 / 10; ++i)
        ASSERT_NEAR(loop[i], original(double(i - kRate)), 1e-5) << i;
    const std::vector<float> whole = heard("loop", 2.5);
    for (size_t i = kRate * 21 / 10; i < kRate * 24 / 10; ++i)
        ASSERT_NEAR(whole[i], original(double(i - 2 * kRate)), 1e-5) << "the last frame sounds as long as others";
    EXPECT_GT(loudest(whole, 1.955, 1.975), 0.4f);
    const std::vector<float> back = heard("reverse", 1.5);
    const double last = 49.0 / kFps * kRate;  // the beginning of the last frame is shown first
    for (size_t i = kRate / 10; i < kRate; ++i) ASSERT_NEAR(back[i], original(last - double(i)), 1e-5) << i;
}

TEST(Heard, WhatStandsStillIsSilent) {
    const std::vector<float> pause = heard("pause:1s:0.5s", 2);
    EXPECT_GT(loudest(pause, 0.5, 0.95), 0.2f);
    EXPECT_EQ(loudest(pause, 1.05, 1.45), 0);
    EXPECT_GT(loudest(pause, 1.55, 1.9), 0.2f);
    EXPECT_EQ(loudest(heard("freeze:1s", 1), 0, 1), 0);
    EXPECT_EQ(loudest(heard("", 3), 2.05, 3), 0) << "behind its end";
}

TEST(Heard, AnotherSpeedHasTheSamePitch) {
    for (const char* map : {"speed:0.5", "speed:1.5", "speed:0.9", "reverse,speed:0.7"}) {
        SCOPED_TRACE(map);
        const std::vector<float> all = heard(map, 1.2);
        EXPECT_NEAR(pitch_hz(all, 0.2, 1.1), 440, 12);
        const double still_at = std::string(map).starts_with("reverse") ? 1.96 - 0.7 : std::stod(map + 6);
        EXPECT_NEAR(loudest(all, 0.98, 1.02), 16000.0 / 32768 * (0.5 + 0.25 * still_at), 0.06) << "as loud as there";
    }
}

TEST(Heard, NothingClicks) {
    const float usual = steepest(heard("", 1.9));
    for (const char* map : {"loop:0.1s:0.73s", "jump:0.51s:1.32s", "pause:0.37s:0.2s", "ping-pong:0.2s:0.9s",
                            "speed:0.63", "offset:0.013s", "clip:0.3s:0.8s"}) {
        SCOPED_TRACE(map);
        EXPECT_LT(steepest(heard(map, 1.9)), 1.5f * usual);
    }
}

}  // namespace
}  // namespace neuvv::test::heard_test
