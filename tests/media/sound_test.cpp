// Sounds of files, and tracks of videos.
#include "media/sound.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "media/video.h"
#include "support/input_error.h"
#include "support/temporary_folder.h"
#include "support/wav_file.h"

namespace neuvv::test::sound_test {
namespace {

struct SoundTest : testing::Test {
    TemporaryFolder folder;
    std::filesystem::path wav = folder.path / "a.wav", video = folder.path / "a.mp4";

    void write_video(uint32_t images, double fps) const {
        media::VideoWriter writer(video, 32, 32, fps);
        for (uint32_t i = 0; i < images; i++) {
            media::Image image(32, 32);
            for (size_t at = 0; at < image.rgba.size(); at++) image.rgba[at] = static_cast<uint8_t>(at + 9 * size_t{i});
            writer.add(image);
        }
        writer.finish();
    }
    // A sine of 440 Hz.
    static media::NextSamples tone(double amplitude) {
        return [amplitude, next = 0](auto& samples) mutable {
            for (media::StereoSample& sample : samples) {
                const auto value =
                    static_cast<float>(amplitude * std::sin(2 * std::numbers::pi * 440 * next++ / media::kSoundRate));
                sample = {value, value};
            }
        };
    }
};

TEST_F(SoundTest, SamplesOfThisRateAreAsTheyAre) {
    const std::vector<int16_t> tone = stereo_tone(5000);
    write_wav(wav, tone, 2, media::kSoundRate);
    const media::Sound sound = media::read_sound(wav);
    ASSERT_EQ(sound.samples.size(), 5000u);
    for (size_t i = 0; i < 5000; i++) {
        EXPECT_EQ(sound.samples[i][0], tone[2 * i]) << i;
        EXPECT_EQ(sound.samples[i][1], tone[2 * i + 1]) << i;
    }
}

TEST_F(SoundTest, OtherRatesAndChannelsAreConverted) {
    std::vector<int16_t> mono;
    for (uint32_t i = 0; i < 22050; i++)
        mono.push_back(static_cast<int16_t>(std::lround(9000 * std::sin(2 * std::numbers::pi * 440 * i / 22050))));
    write_wav(wav, mono, 1, 22050);
    const media::Sound sound = media::read_sound(wav);
    EXPECT_NEAR(sound.length_s(), 1, 0.002);
    double apart = 0;
    for (size_t i = 4800; i < 43200; i++) {  // not where the filter begins and ends
        EXPECT_EQ(sound.samples[i][0], sound.samples[i][1]) << i;
        const double phase = 2 * std::numbers::pi * 440 * static_cast<double>(i) / media::kSoundRate;
        const double expected = 9000 * std::sin(phase);
        apart = std::max(apart, std::abs(sound.samples[i][0] - expected));
    }
    EXPECT_LT(apart, 3000) << "one channel is heard from both sides, as loud or 3 dB softer";
}

TEST_F(SoundTest, AVideoGetsATrack) {
    write_video(25, 12.5);
    const media::VideoSummary before = media::summarise_video(video);
    for (const double amplitude : {0.1, 0.5}) {  // a second one replaces the first
        media::add_sound(video, tone(amplitude));
        const media::VideoSummary after = media::summarise_video(video);
        EXPECT_EQ(after.frames, before.frames);
        EXPECT_EQ(after.fps, before.fps);
        const media::Sound sound = media::read_sound(video);
        EXPECT_NEAR(sound.length_s(), 2, 0.05);
        double noise = 0, power = 0;
        for (size_t i = 4800; i < 86400; i++) {
            const double expected =
                amplitude * std::sin(2 * std::numbers::pi * 440 * static_cast<double>(i) / media::kSoundRate);
            noise += std::pow(sound.samples[i][0] / 32768.0 - expected, 2);
            power += expected * expected;
        }
        EXPECT_GT(10 * std::log10(power / noise), 25) << "it is where it belongs, by the sample";
    }
}

TEST_F(SoundTest, WhatHasNoSoundIsRefused) {
    std::ofstream(folder.path / "text.wav") << "no sound at all";
    expect_input_error([&] { media::read_sound(folder.path / "text.wav"); }, {"text.wav", ".flac"});
    expect_input_error([&] { media::read_sound(folder.path / "none.wav"); }, {"none.wav"});
    write_video(3, 10);
    expect_input_error([&] { media::read_sound(video); }, {"a.mp4", "has no sound"});
    write_wav(wav, {}, 2, media::kSoundRate);
    expect_input_error([&] { media::read_sound(wav); }, {"a.wav"});
    expect_input_error([&] { media::add_sound(wav, tone(1)); }, {"a.wav"});
    std::ofstream(folder.path / "list.wav") << "ffconcat version 1.0\nfile /etc/hostname\n";
    expect_input_error([&] { media::read_sound(folder.path / "list.wav"); }, {"list.wav"});
}

}  // namespace
}  // namespace neuvv::test::sound_test
