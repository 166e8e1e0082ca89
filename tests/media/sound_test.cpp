// Sounds of files, and tracks of videos.
#include "media/sound.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <numbers>

#include "base/error.h"
#include "base/platform.h"
#include "media/libav.h"
#include "media/sound_peaks.h"
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
        for (uint32_t i = 0; i < images; ++i) {
            media::Image image(32, 32);
            for (size_t at = 0; at < image.rgba.size(); ++at) image.rgba[at] = static_cast<uint8_t>(at + 9 * size_t{i});
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
    for (size_t i = 0; i < 5000; ++i) {
        EXPECT_EQ(sound.samples[i][0], tone[2 * i]) << i;
        EXPECT_EQ(sound.samples[i][1], tone[2 * i + 1]) << i;
    }
}

TEST_F(SoundTest, OtherRatesAndChannelsAreConverted) {
    std::vector<int16_t> mono;
    for (uint32_t i = 0; i < 22050; ++i)
        mono.push_back(static_cast<int16_t>(std::lround(9000 * std::sin(2 * std::numbers::pi * 440 * i / 22050))));
    write_wav(wav, mono, 1, 22050);
    const media::Sound sound = media::read_sound(wav);
    EXPECT_NEAR(sound.length_s(), 1, 0.002);
    double apart = 0;
    for (size_t i = 4800; i < 43200; ++i) {  // not where the filter begins and ends
        EXPECT_EQ(sound.samples[i][0], sound.samples[i][1]) << i;
        const double phase = 2 * std::numbers::pi * 440 * static_cast<double>(i) / media::kSoundRate;
        const double expected = 9000 * std::sin(phase);
        apart = std::max(apart, std::abs(sound.samples[i][0] - expected));
    }
    EXPECT_LT(apart, 3000) << "one channel is heard from both sides, as loud or 3 dB softer";
}

// Appends a sine of 440 Hz to a file of AAC frames.
void append_aac(const std::filesystem::path& path, int channels, int rate, int frames) {
    AVCodecContext* codec = avcodec_alloc_context3(avcodec_find_encoder(AV_CODEC_ID_AAC));
    codec->sample_fmt = AV_SAMPLE_FMT_FLTP;
    codec->sample_rate = rate;
    av_channel_layout_default(&codec->ch_layout, channels);
    ASSERT_GE(avcodec_open2(codec, nullptr, nullptr), 0);
    AVFormatContext* output = nullptr;
    const std::string part = path.string() + ".part";
    ASSERT_GE(avformat_alloc_output_context2(&output, nullptr, "adts", part.c_str()), 0);
    AVStream* stream = avformat_new_stream(output, nullptr);
    avcodec_parameters_from_context(stream->codecpar, codec);
    ASSERT_GE(avio_open(&output->pb, part.c_str(), AVIO_FLAG_WRITE), 0);
    ASSERT_GE(avformat_write_header(output, nullptr), 0);
    AVPacket* packet = av_packet_alloc();
    const auto write = [&] {
        while (avcodec_receive_packet(codec, packet) >= 0) av_write_frame(output, packet);
    };
    for (int i = 0; i < frames; ++i) {
        AVFrame* frame = av_frame_alloc();
        frame->format = AV_SAMPLE_FMT_FLTP;
        frame->nb_samples = codec->frame_size;
        av_channel_layout_copy(&frame->ch_layout, &codec->ch_layout);
        ASSERT_GE(av_frame_get_buffer(frame, 0), 0);
        for (int c = 0; c < channels; ++c)
            for (int s = 0; s < frame->nb_samples; ++s)
                reinterpret_cast<float*>(frame->extended_data[c])[s] = static_cast<float>(
                    0.5 * std::sin(2 * std::numbers::pi * 440 * (double(i) * frame->nb_samples + s) / rate));
        frame->pts = int64_t{i} * frame->nb_samples;
        avcodec_send_frame(codec, frame);
        write();
        av_frame_free(&frame);
    }
    avcodec_send_frame(codec, nullptr);
    write();
    av_write_trailer(output);
    avio_closep(&output->pb);
    avformat_free_context(output);
    av_packet_free(&packet);
    avcodec_free_context(&codec);
    std::ofstream(path, std::ios::binary | std::ios::app) << std::ifstream(part, std::ios::binary).rdbuf();
}

// Files that were put behind each other: stereo at 48 kHz, then mono at 24 kHz.
TEST_F(SoundTest, ASoundMayChangeItsForm) {
    const std::filesystem::path file = folder.path / "two.aac";
    append_aac(file, 2, 48000, 48);  // 1.02 s
    append_aac(file, 1, 24000, 24);  // 1.02 s
    const media::Sound sound = media::read_sound(file);
    EXPECT_NEAR(sound.length_s(), 2.1, 0.1);
    for (const double from_s : {0.3, 1.4}) {
        int crossings = 0;
        const auto begin = static_cast<size_t>(from_s * media::kSoundRate);
        for (size_t i = begin; i < begin + media::kSoundRate / 2; ++i)
            for (const size_t side : {0u, 1u})
                crossings += sound.samples[i][side] < 0 && sound.samples[i + 1][side] >= 0;
        EXPECT_NEAR(crossings, 440, 8) << "half a second of both sides, from " << from_s;
    }
}

TEST_F(SoundTest, WrongRatesAreRefused) {
    write_wav(wav, stereo_tone(2000), 2, 1);
    expect_input_error([&] { media::read_sound(wav); }, {"a.wav", "1 Hz"});
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
        for (size_t i = 4800; i < 86400; ++i) {
            const double expected =
                amplitude * std::sin(2 * std::numbers::pi * 440 * static_cast<double>(i) / media::kSoundRate);
            noise += std::pow(sound.samples[i][0] / 32768.0 - expected, 2);
            power += expected * expected;
        }
        EXPECT_GT(10 * std::log10(power / noise), 25) << "it is where it belongs, by the sample";
    }
}

TEST_F(SoundTest, ASoundIsWrittenByItself) {
    test::write_wav(wav, test::stereo_tone(media::kSoundRate), 2, media::kSoundRate);
    const media::Sound before = media::read_sound(wav);
    media::write_sound(folder.path / "a.m4a", before);
    const media::Sound after = media::read_sound(folder.path / "a.m4a");
    EXPECT_NEAR(after.length_s(), before.length_s(), 0.025);
    for (size_t side = 0; side < 2; ++side) {
        double noise = 0, power = 0;
        for (size_t i = 4800; i < 43200; ++i) {
            noise += std::pow(after.samples[i][side] - before.samples[i][side], 2);
            power += std::pow(before.samples[i][side], 2);
        }
        EXPECT_GT(10 * std::log10(power / noise), 25) << "side " << side;
    }
    EXPECT_THROW(media::write_sound(folder.path / "missing" / "a.m4a", before), RuntimeFailure);
}

TEST_F(SoundTest, AFileInMemoryIsHeardAsOnTheDisk) {
    media::Sound sound;
    for (const int16_t value : stereo_tone(media::kSoundRate / 2)) sound.samples.push_back({value, value});
    const std::filesystem::path file = folder.path / "a.m4a";
    media::write_sound(file, sound);
    const auto content = std::make_shared<const std::vector<uint8_t>>(read_file(file));
    const media::Sound read = media::read_sound({"https://host/a.m4a", content});
    EXPECT_GT(read.samples.size(), sound.samples.size() / 2);
    EXPECT_EQ(read.samples, media::read_sound(file).samples);
    const auto peaks = media::read_sound_peaks({"https://host/a.m4a", content}, [] { return true; });
    EXPECT_GT(peaks->largest(0.1, 0.2), 0.2f);
    for (const size_t kept : {size_t{0}, size_t{1}, size_t{100}, content->size() / 2}) {
        const auto cut = std::make_shared<const std::vector<uint8_t>>(content->begin(),
                                                                      content->begin() + static_cast<ptrdiff_t>(kept));
        try {
            EXPECT_LE(media::read_sound({"https://host/a.m4a", cut}).samples.size(), read.samples.size());
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("https://host/a.m4a"), std::string::npos) << error.what();
        }
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
