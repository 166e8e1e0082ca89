#include "media/video.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/input_error.h"
#include "support/temporary_folder.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

namespace neuvv {
namespace {

media::Image plain(uint32_t width, uint32_t height, uint8_t r, uint8_t g, uint8_t b) {
    media::Image image(width, height);
    for (size_t i = 0; i < image.rgba.size(); i += 4) {
        const uint8_t colour[4] = {r, g, b, 255};
        std::copy(colour, colour + 4, image.rgba.begin() + static_cast<ptrdiff_t>(i));
    }
    return image;
}

void write_video(const std::filesystem::path& path, uint32_t width, uint32_t height, double fps, int frames) {
    media::VideoWriter video(path, width, height, fps);
    for (int i = 0; i < frames; ++i) video.add(plain(width, height, static_cast<uint8_t>(9 * i), 80, 160));
    video.finish();
}

TEST(Video, SummaryIsWhatWasWritten) {
    const TemporaryFolder folder;
    const auto path = folder.path / "a:b.mp4";  // the part before the colon must not be taken for a protocol
    write_video(path, 64, 48, 25, 24);
    const media::VideoSummary summary = media::summarise_video(path);
    EXPECT_EQ(summary.width, 64u);
    EXPECT_EQ(summary.height, 48u);
    EXPECT_EQ(summary.frames, 24u);
    EXPECT_NEAR(summary.fps, 25, 1e-6);
    EXPECT_EQ(folder.entries(), 1u) << "a temporary file stayed";
}

// Presentation times of a file's packets, ascending, in units of `base`.
std::vector<int64_t> times_of(const std::filesystem::path& path, AVRational& base) {
    AVFormatContext* input = nullptr;
    EXPECT_EQ(avformat_open_input(&input, path.c_str(), nullptr, nullptr), 0);
    std::vector<int64_t> times;
    AVPacket* packet = av_packet_alloc();
    while (av_read_frame(input, packet) >= 0) {
        times.push_back(packet->pts);
        base = input->streams[0]->time_base;
        av_packet_unref(packet);
    }
    av_packet_free(&packet);
    avformat_close_input(&input);
    std::sort(times.begin(), times.end());
    return times;
}

// A joined video shows the frames of its parts, at the times that one video would have.
TEST(Video, PartsAreJoined) {
    const TemporaryFolder folder;
    const std::filesystem::path whole = folder.path / "whole.mp4", joined = folder.path / "joined.mp4";
    const int ends[] = {2, 3, 20};
    media::VideoWriter all(whole, 62, 48, 30000.0 / 1001);
    std::vector<std::filesystem::path> parts;
    for (int part = 0, i = 0; part < 3; ++part) {
        parts.push_back(folder.path / (std::to_string(part) + ".mp4"));
        media::VideoWriter video(parts.back(), 62, 48, 30000.0 / 1001);
        for (; i < ends[part]; ++i) {
            const media::Image image =
                plain(62, 48, static_cast<uint8_t>(10 * i), 80, static_cast<uint8_t>(200 - 7 * i));
            video.add(image);
            all.add(image);
        }
        video.finish();
    }
    all.finish();
    media::join_videos(parts, joined, "the joined ones");
    EXPECT_EQ(media::comment_of_video(joined), "the joined ones");
    EXPECT_EQ(media::comment_of_video(whole), "");
    EXPECT_EQ(folder.entries(), 5u) << "a temporary file stayed";
    const media::VideoSummary summary = media::summarise_video(joined);
    EXPECT_EQ(summary.frames, 20u);
    EXPECT_NEAR(summary.fps, 30000.0 / 1001, 1e-3);
    media::VideoReader a(whole), b(joined);
    media::Image of_a, of_b;
    for (int i = 0; i < 20; ++i) {
        ASSERT_TRUE(a.next(of_a) && b.next(of_b)) << i;
        for (size_t p = 0; p < of_a.rgba.size(); ++p) ASSERT_NEAR(of_a.rgba[p], of_b.rgba[p], 4) << "frame " << i;
    }
    AVRational base_a{}, base_b{};
    EXPECT_EQ(times_of(whole, base_a), times_of(joined, base_b));
    EXPECT_EQ(av_cmp_q(base_a, base_b), 0);
}

TEST(Video, PartsThatDoNotFitAreNotJoined) {
    const TemporaryFolder folder;
    const auto path = [&](const char* name) { return folder.path / name; };
    write_video(path("a.mp4"), 64, 48, 25, 3);
    write_video(path("small.mp4"), 32, 48, 25, 3);
    write_video(path("slow.mp4"), 64, 48, 24, 3);
    const auto refuse = [&](const char* other, const char* reason) {
        expect_input_error(
            [&] {
                media::join_videos({path("a.mp4"), path(other)}, path("joined.mp4"));
            },
            {other, reason});
    };
    refuse("small.mp4", "another size");
    refuse("slow.mp4", "another size, rate");
    refuse("none.mp4", "cannot be opened");
    for (const uintmax_t missing : {3, 100}) {
        std::filesystem::copy_file(path("a.mp4"), path("cut.mp4"), std::filesystem::copy_options::overwrite_existing);
        std::filesystem::resize_file(path("cut.mp4"), std::filesystem::file_size(path("a.mp4")) - missing);
        refuse("cut.mp4", "cut");
    }
    EXPECT_FALSE(std::filesystem::exists(path("joined.mp4")));
    EXPECT_EQ(folder.entries(), 4u) << "a temporary file stayed";
}

TEST(Video, OddSizesArePaddedAndFractionalRatesKept) {
    const TemporaryFolder folder;
    write_video(folder.path / "odd.mp4", 33, 17, 30000.0 / 1001, 7);
    const media::VideoSummary summary = media::summarise_video(folder.path / "odd.mp4");
    EXPECT_EQ(summary.width, 34u);
    EXPECT_EQ(summary.height, 18u);
    EXPECT_EQ(summary.frames, 7u);
    EXPECT_NEAR(summary.fps, 30000.0 / 1001, 1e-3);
}

// Frame i is at i / fps, without rounding and so without drift.
TEST(Video, TimestampsAreExact) {
    const TemporaryFolder folder;
    const auto path = folder.path / "a.mp4";
    for (const AVRational rate : {AVRational{25, 1}, AVRational{30000, 1001}, AVRational{2997, 100}, AVRational{25, 2},
                                  AVRational{1, 3}, AVRational{120, 1}, AVRational{7, 3}}) {
        write_video(path, 16, 16, av_q2d(rate), 200);
        AVRational base{};
        const std::vector<int64_t> times = times_of(path, base);
        ASSERT_EQ(times.size(), 200u);
        for (int64_t i = 0; i < 200; ++i)
            EXPECT_EQ(av_compare_ts(times[static_cast<size_t>(i)], base, i, av_inv_q(rate)), 0)
                << i << " at " << rate.num << "/" << rate.den;
        EXPECT_NE(av_compare_ts(times[100], base, 100, av_inv_q({rate.num * 1001, rate.den * 1000})), 0);
    }
}

TEST(Video, OneFrameIsAVideo) {
    const TemporaryFolder folder;
    write_video(folder.path / "one.mp4", 16, 16, 10, 1);
    EXPECT_EQ(media::summarise_video(folder.path / "one.mp4").frames, 1u);
}

// Decodes the first frame and returns its Y, Cb, Cr and tags: pure red is (63, 102, 240) in BT.709 and (81, 90, 240) in
// BT.601, and a player chooses by the tags.
TEST(Video, ColoursAreBt709) {
    const TemporaryFolder folder;
    const auto path = folder.path / "red.mp4";
    media::VideoWriter writer(path, 64, 64, 25);
    for (int i = 0; i < 3; ++i) writer.add(plain(64, 64, 255, 0, 0));
    writer.finish();

    AVFormatContext* input = nullptr;
    ASSERT_EQ(avformat_open_input(&input, path.c_str(), nullptr, nullptr), 0);
    ASSERT_GE(avformat_find_stream_info(input, nullptr), 0);
    const AVCodecParameters& parameters = *input->streams[0]->codecpar;
    EXPECT_EQ(parameters.color_space, AVCOL_SPC_BT709);
    EXPECT_EQ(parameters.color_primaries, AVCOL_PRI_BT709);
    EXPECT_EQ(parameters.color_trc, AVCOL_TRC_BT709);
    AVCodecContext* codec = avcodec_alloc_context3(avcodec_find_decoder(parameters.codec_id));
    ASSERT_GE(avcodec_parameters_to_context(codec, &parameters), 0);
    ASSERT_EQ(avcodec_open2(codec, nullptr, nullptr), 0);
    AVPacket* packet = av_packet_alloc();
    AVFrame* frame = av_frame_alloc();
    int got = AVERROR(EAGAIN);
    while (got == AVERROR(EAGAIN)) {
        const bool more = av_read_frame(input, packet) == 0;
        avcodec_send_packet(codec, more ? packet : nullptr);
        av_packet_unref(packet);
        got = avcodec_receive_frame(codec, frame);
    }
    ASSERT_EQ(got, 0);
    EXPECT_EQ(frame->format, AV_PIX_FMT_YUV420P);
    const int expected[3] = {63, 102, 240};
    for (int plane = 0; plane < 3; ++plane) {
        const int side = plane == 0 ? 32 : 16;
        EXPECT_NEAR(frame->data[plane][side * frame->linesize[plane] + side], expected[plane], 3) << plane;
    }
    av_frame_free(&frame);
    av_packet_free(&packet);
    avcodec_free_context(&codec);
    avformat_close_input(&input);
}

// An image whose alpha takes all values, with colours where it is transparent, too.
media::Image faded(uint32_t width, uint32_t height, int shift) {
    media::Image image(width, height);
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            const uint8_t pixel[4] = {static_cast<uint8_t>(40 + 2 * y), static_cast<uint8_t>(200 - x / 2),
                                      static_cast<uint8_t>(20 * shift), static_cast<uint8_t>(x)};
            std::copy(pixel, pixel + 4, image.at(x, y));
        }
    return image;
}

TEST(Video, AMovIsProRes4444WithStraightAlpha) {
    const TemporaryFolder folder;
    const std::filesystem::path whole = folder.path / "whole.mov";
    std::vector<std::filesystem::path> parts;
    for (const int first : {0, 2}) {
        parts.push_back(folder.path / (std::to_string(first) + ".mov"));
        media::VideoWriter writer(parts.back(), 256, 63, 24);
        for (int i = first; i < first + 2; ++i) writer.add(faded(256, 63, i));
        writer.finish();
    }
    media::join_videos(parts, whole, "of two");
    EXPECT_EQ(media::comment_of_video(whole), "of two");
    EXPECT_EQ(folder.entries(), 3u) << "a temporary file stayed";
    AVFormatContext* input = nullptr;
    ASSERT_EQ(avformat_open_input(&input, whole.c_str(), nullptr, nullptr), 0);
    ASSERT_GE(avformat_find_stream_info(input, nullptr), 0);
    const AVCodecParameters parameters = *input->streams[0]->codecpar;
    EXPECT_EQ(parameters.codec_id, AV_CODEC_ID_PRORES);
    EXPECT_EQ(parameters.codec_tag, MKTAG('a', 'p', '4', 'h'));
    EXPECT_EQ(parameters.color_space, AVCOL_SPC_BT709);
    EXPECT_EQ(parameters.color_primaries, AVCOL_PRI_BT709);
    EXPECT_EQ(parameters.color_trc, AVCOL_TRC_BT709);
    avformat_close_input(&input);
    media::VideoReader reader(whole);
    EXPECT_EQ(reader.frames(), 4u);
    media::Image seen;
    for (int i = 0; i < 4; ++i) {
        ASSERT_TRUE(reader.next(seen));
        ASSERT_EQ(seen.height, 64u) << "the last row is repeated";
        const media::Image truth = faded(256, 63, i);
        int worst_colour = 0, worst_alpha = 0;
        for (size_t p = 0; p < truth.rgba.size(); ++p) {
            int& worst = p % 4 == 3 ? worst_alpha : worst_colour;
            worst = std::max(worst, std::abs(seen.rgba[p] - truth.rgba[p]));
        }
        EXPECT_LE(worst_alpha, 1) << i;
        EXPECT_LE(worst_colour, 2) << i;
        EXPECT_EQ(seen.at(0, 20)[3], 0);
        EXPECT_EQ(seen.at(255, 20)[3], 255);
        EXPECT_GT(seen.at(0, 20)[0], 70) << "colours of transparent pixels are kept: alpha is straight";
    }
}

TEST(Video, IndexStandsBeforeTheFrames) {
    const TemporaryFolder folder;
    write_video(folder.path / "a.mp4", 32, 32, 25, 5);
    const std::string bytes = read_text(folder.path / "a.mp4");
    ASSERT_NE(bytes.find("moov"), std::string::npos);
    EXPECT_LT(bytes.find("moov"), bytes.find("mdat"));
}

TEST(Video, WithoutFinishNothingStays) {
    const TemporaryFolder folder;
    {
        media::VideoWriter video(folder.path / "a.mp4", 32, 32, 25);
        video.add(plain(32, 32, 1, 2, 3));
        media::VideoWriter moved(std::move(video));
        EXPECT_EQ(folder.entries(), 1u);
    }
    EXPECT_EQ(folder.entries(), 0u);
}

TEST(Video, WhatCannotBeWrittenIsRefused) {
    const TemporaryFolder folder;
    const auto path = folder.path / "a.mp4";
    EXPECT_THROW(media::VideoWriter(path, 0, 32, 25), RuntimeFailure);
    EXPECT_THROW(media::VideoWriter(path, 32, 32, 0), RuntimeFailure);
    EXPECT_THROW(media::VideoWriter(path, 32, 32, NAN), RuntimeFailure);
    EXPECT_THROW(media::VideoWriter(folder.path / "none" / "a.mp4", 32, 32, 25), RuntimeFailure);
    media::VideoWriter video(path, 32, 32, 25);
    EXPECT_THROW(video.add(plain(32, 31, 0, 0, 0)), RuntimeFailure);
    EXPECT_THROW(video.finish(), RuntimeFailure);
}

TEST(Video, WhatCannotBeReadIsNamed) {
    const TemporaryFolder folder;
    expect_input_error([&] { media::summarise_video(folder.path / "none.mp4"); },
                       {"none.mp4", "cannot open", "check the path"});
    write_text(folder.path / "text.mp4", "#EXTM3U\nhttp://example.org/a.ts\n");
    expect_input_error([&] { media::summarise_video(folder.path / "text.mp4"); },
                       {"text.mp4", "cannot open", "FFmpeg"});
    write_video(folder.path / "a.mp4", 64, 64, 25, 24);
    const std::string bytes = read_text(folder.path / "a.mp4");
    for (const double part : {0.01, 0.3, 0.6, 0.9}) {
        write_text(folder.path / "cut.mp4", bytes.substr(0, static_cast<size_t>(part * double(bytes.size()))));
        expect_input_error([&] { media::summarise_video(folder.path / "cut.mp4"); }, {"cut.mp4"});
    }
}

TEST(VideoReader, FramesAreThoseWritten) {
    const TemporaryFolder folder;
    const auto path = folder.path / "a.mp4";
    write_video(path, 66, 34, 12.5, 20);
    media::VideoReader reader(path);
    EXPECT_EQ(reader.size(), (media::ImageSize{66, 34}));
    EXPECT_EQ(reader.frames(), 20u);
    EXPECT_NEAR(reader.fps(), 12.5, 1e-6);
    media::Image frame;
    for (int i = 0; i < 20; ++i) {
        if (i % 3 == 2) {
            ASSERT_TRUE(reader.skip());
            continue;
        }
        ASSERT_TRUE(reader.next(frame));
        ASSERT_EQ(frame.width, 66u);
        ASSERT_EQ(frame.height, 34u);
        for (const uint32_t x : {0u, 33u, 65u}) {
            EXPECT_NEAR(frame.at(x, 17)[0], 9 * i, 4) << i;
            EXPECT_NEAR(frame.at(x, 17)[1], 80, 4);
            EXPECT_NEAR(frame.at(x, 17)[2], 160, 4);
            EXPECT_EQ(frame.at(x, 17)[3], 255);
        }
    }
    EXPECT_FALSE(reader.next(frame));
    EXPECT_FALSE(reader.skip());
}

TEST(VideoReader, AShortFileIsNoticedAtItsEnd) {
    const TemporaryFolder folder;
    write_video(folder.path / "a.mp4", 64, 64, 25, 24);
    const std::string bytes = read_text(folder.path / "a.mp4");
    write_text(folder.path / "cut.mp4", bytes.substr(0, bytes.size() * 9 / 10));
    expect_input_error(
        [&] {
            media::VideoReader reader(folder.path / "cut.mp4");
            media::Image frame;
            while (reader.next(frame)) {
            }
        },
        {"cut.mp4"});
    expect_input_error([&] { media::VideoReader reader(folder.path / "none.mp4"); }, {"none.mp4", "cannot open"});
}

// Any bytes may be damaged: reading must give an InputError or frames of the right size, nothing else.
TEST(VideoReader, DamagedBytesDoNoHarm) {
    const TemporaryFolder folder;
    write_video(folder.path / "a.mp4", 64, 48, 25, 12);
    const std::string whole = read_text(folder.path / "a.mp4");
    uint32_t state = 11;
    for (int round = 0; round < 60; ++round) {
        std::string bytes = whole;
        for (int i = 0; i < 8; ++i) {
            state = state * 1664525 + 1013904223;
            bytes[(state >> 8) % bytes.size()] = static_cast<char>(state);
        }
        write_text(folder.path / "bad.mp4", bytes);
        try {
            media::VideoReader reader(folder.path / "bad.mp4");
            media::Image frame;
            while (reader.next(frame)) ASSERT_EQ(frame.rgba.size(), size_t{4} * frame.width * frame.height);
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("bad.mp4"), std::string::npos);
        }
    }
}

}  // namespace
}  // namespace neuvv
