// What a file says about how its images are shown: turns, edit lists, colours, times.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "media/orientation.h"
#include "media/video.h"
#include "media/video_colour.h"
#include "media/video_times.h"
#include "support/input_error.h"
#include "support/jpeg_file.h"
#include "support/temporary_folder.h"
#include "support/video_file.h"

namespace neuvv {
namespace {

using media::Orientation;
using test::exif;
using test::jpeg;
using test::VideoFile;

// 3×2 pixels whose red is 1 2 3 in the first row and 4 5 6 in the second.
media::Image numbered() {
    media::Image image(3, 2);
    for (uint8_t i = 0; i < 6; ++i) image.rgba[size_t{4} * i] = static_cast<uint8_t>(i + 1);
    return image;
}

std::vector<int> reds(const media::Image& image) {
    std::vector<int> values;
    for (size_t i = 0; i < image.rgba.size(); i += 4) values.push_back(image.rgba[i]);
    return values;
}

// By Exif's own definition of where the stored first row and first column are shown.
const std::array<std::vector<int>, 9> kShown = {{{},
                                                 {1, 2, 3, 4, 5, 6},
                                                 {3, 2, 1, 6, 5, 4},
                                                 {6, 5, 4, 3, 2, 1},
                                                 {4, 5, 6, 1, 2, 3},
                                                 {1, 4, 2, 5, 3, 6},
                                                 {4, 1, 5, 2, 6, 3},
                                                 {6, 3, 5, 2, 4, 1},
                                                 {3, 6, 2, 5, 1, 4}}};

TEST(Orientation, PixelsGoWhereExifSays) {
    for (int i = 1; i <= 8; ++i) {
        const media::Image image = media::shown(numbered(), static_cast<Orientation>(i));
        EXPECT_EQ(image.width, i >= 5 ? 2u : 3u);
        EXPECT_EQ(reds(image), kShown[static_cast<size_t>(i)]) << i;
    }
}

TEST(Orientation, IsReadFromJpegs) {
    const TemporaryFolder folder;
    const auto header_of = [&](const std::string& bytes) {
        write_text(folder.path / "a.jpg", bytes);
        const media::ImageHeader header = media::image_header(folder.path / "a.jpg");
        const media::ImageHeader same =
            media::image_header(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(), "a.jpg");
        EXPECT_EQ(header.stored, (media::ImageSize{16, 8}));
        EXPECT_EQ(same.stored, header.stored);
        EXPECT_EQ(same.orientation, header.orientation);
        return header.orientation;
    };
    EXPECT_EQ(header_of(jpeg("")), Orientation::kUpright);
    for (int i = 1; i <= 8; ++i)
        for (const bool big : {false, true}) EXPECT_EQ(header_of(jpeg(exif(i, big))), static_cast<Orientation>(i));
    for (const int wrong : {0, 9, 65535}) EXPECT_EQ(header_of(jpeg(exif(wrong, true))), Orientation::kUpright);
    const std::string whole = exif(6, false);
    for (size_t length = 1; length < 34; ++length)  // until the tag is whole
        EXPECT_EQ(header_of(jpeg(whole.substr(0, length))), Orientation::kUpright) << length;
}

TEST(Orientation, IsReadFromPngs) {
    const TemporaryFolder folder;
    const std::vector<uint8_t> plain = media::encode_png(numbered());
    const std::string bytes(plain.begin(), plain.end()), data = exif(8, true);
    const auto big_endian = [](uint32_t value) {
        std::string text;
        for (int i = 3; i >= 0; --i) text += static_cast<char>(value >> 8 * i);
        return text;
    };
    // Behind IHDR; the checksum is not looked at in headers.
    const std::string with_exif = bytes.substr(0, 33) + big_endian(static_cast<uint32_t>(data.size())) + "eXIf" + data +
                                  big_endian(0) + bytes.substr(33);
    write_text(folder.path / "a.png", with_exif);
    EXPECT_EQ(media::image_header(folder.path / "a.png").orientation, Orientation::kTurned270);
    EXPECT_EQ(media::image_header(folder.path / "a.png").stored, (media::ImageSize{3, 2}));
    write_text(folder.path / "b.png", bytes);
    EXPECT_EQ(media::image_header(folder.path / "b.png").orientation, Orientation::kUpright);
}

constexpr int32_t kOne = 1 << 16;

// The turn that each matrix of an MP4 says; of mirrors, too.
const std::array<std::vector<int32_t>, 9> kMatrices = {{{},
                                                        {kOne, 0, 0, kOne},
                                                        {-kOne, 0, 0, kOne},
                                                        {-kOne, 0, 0, -kOne},
                                                        {kOne, 0, 0, -kOne},
                                                        {0, kOne, kOne, 0},
                                                        {0, kOne, -kOne, 0},
                                                        {0, -kOne, -kOne, 0},
                                                        {0, -kOne, kOne, 0}}};

std::vector<int32_t> nine(const std::vector<int32_t>& four) {
    return {four[0], four[1], 0, four[2], four[3], 0, 0, 0, 1 << 30};
}

// The same pixels, turned by the container and turned by Exif's rule, are the same image.
TEST(VideoReader, TurnsWhatTheFileSaysIsTurned) {
    const TemporaryFolder folder;
    media::Image stored;
    for (int i = 1; i <= 8; ++i) {
        VideoFile video{{0, 40}};
        video.matrix = nine(kMatrices[static_cast<size_t>(i)]);
        video.paint = test::paint_quarters;
        test::write_video_file(folder.path / "a.mp4", video);
        media::VideoReader reader(folder.path / "a.mp4");
        media::Image frame;
        ASSERT_TRUE(reader.next(frame));
        if (i == 1) stored = frame;
        EXPECT_EQ(reader.size(), (i >= 5 ? media::ImageSize{48, 64} : media::ImageSize{64, 48}));
        EXPECT_EQ((media::ImageSize{frame.width, frame.height}), reader.size());
        EXPECT_EQ(frame.rgba, media::shown(stored, static_cast<Orientation>(i)).rgba) << i;
        EXPECT_EQ(reader.notes().size(), i == 1 ? 0u : 1u);
    }
    VideoFile askew{{0}};
    askew.matrix = nine({46341, 46341, -46341, 46341});
    test::write_video_file(folder.path / "a.mp4", askew);
    const media::VideoReader reader(folder.path / "a.mp4");
    ASSERT_EQ(reader.notes().size(), 1u);
    EXPECT_NE(reader.notes()[0].find("not done"), std::string::npos);
}

// An MP4 whose edit list starts at its third frame, as a trimmed recording has it: the others stay in the file.
TEST(VideoReader, FramesThatAnEditListCutsOffAreNotShown) {
    const TemporaryFolder folder;
    test::write_video_file(folder.path / "a.mp4", {{0, 40, 80, 120, 160, 200}});
    std::string bytes = read_text(folder.path / "a.mp4");
    const size_t list = bytes.find("elst");
    ASSERT_NE(list, std::string::npos);
    const auto set = [&](size_t at, uint32_t value) {
        for (int i = 0; i < 4; ++i) bytes[at + static_cast<size_t>(i)] = static_cast<char>(value >> 8 * (3 - i));
    };
    const size_t scale_at = bytes.find("mdhd") + 16;
    uint32_t scale = 0;  // ticks a second of the video
    for (size_t i = 0; i < 4; ++i) scale = scale << 8 | static_cast<uint8_t>(bytes[scale_at + i]);
    set(list + 12, 120);              // it lasts 120 of the file's milliseconds
    set(list + 16, scale * 8 / 100);  // and begins 80 ms after the start
    write_text(folder.path / "cut.mp4", bytes);
    media::VideoReader reader(folder.path / "cut.mp4");
    EXPECT_EQ(reader.frames(), 3u);
    media::Image frame;
    std::vector<int> greys;
    while (reader.next(frame)) greys.push_back(frame.at(30, 20)[0]);
    media::VideoReader whole(folder.path / "a.mp4");
    std::vector<int> all;
    while (whole.next(frame)) all.push_back(frame.at(30, 20)[0]);
    ASSERT_EQ(all.size(), 6u);
    EXPECT_EQ(greys, (std::vector<int>{all[2], all[3], all[4]}));
    const media::VideoTimes times = media::video_times(folder.path / "cut.mp4");
    ASSERT_EQ(times.shown_s.size(), 3u);
    EXPECT_NEAR(times.shown_s[0], 0, 1e-6);
    EXPECT_NEAR(times.shown_s[2], 0.08, 1e-6);
}

// Y', Cb, Cr of ten bits from R, G, B of 0 to 1, in BT.2020's matrix and limited range.
std::array<uint16_t, 3> yuv2020(const std::array<double, 3>& rgb) {
    const double y = 0.2627 * rgb[0] + 0.6780 * rgb[1] + 0.0593 * rgb[2];
    const double u = (rgb[2] - y) / 1.8814, v = (rgb[0] - y) / 1.4746;
    return {static_cast<uint16_t>(std::lround(64 + 876 * y)), static_cast<uint16_t>(std::lround(512 + 896 * u)),
            static_cast<uint16_t>(std::lround(512 + 896 * v))};
}

// What a screen of BT.709 shows as this byte, as light of BT.2020 where the screen's white is 1.
std::array<double, 3> light2020(const std::array<int, 3>& bytes) {
    std::array<double, 3> screen{}, wide{};
    for (size_t c = 0; c < 3; ++c) screen[c] = std::pow(bytes[c] / 255.0, 2.4);
    const double from709[9] = {0.6274, 0.3293, 0.0433, 0.0691, 0.9195, 0.0114, 0.0164, 0.0880, 0.8956};  // BT.2087
    for (size_t c = 0; c < 3; ++c)
        for (size_t k = 0; k < 3; ++k) wide[c] += from709[3 * c + k] * screen[k];
    return wide;
}

// BT.2100: the signal of light relative to a white of 203 cd/m²; the display's gamma is taken of each channel.
std::array<double, 3> hlg(const std::array<double, 3>& light) {
    std::array<double, 3> signal{};
    for (size_t c = 0; c < 3; ++c) {
        const double scene = std::pow(light[c] * 0.203, 1 / 1.2);
        const double a = 0.17883277, b = 1 - 4 * a, k = 0.5 - a * std::log(4 * a);
        signal[c] = scene <= 1.0 / 12 ? std::sqrt(3 * scene) : a * std::log(12 * scene - b) + k;
    }
    return signal;
}
std::array<double, 3> pq(const std::array<double, 3>& light) {
    std::array<double, 3> signal{};
    for (size_t c = 0; c < 3; ++c) {
        const double power = std::pow(light[c] * 0.0203, 0.1593017578125);
        signal[c] = std::pow((0.8359375 + 18.8515625 * power) / (1 + 18.6875 * power), 78.84375);
    }
    return signal;
}
std::array<double, 3> sdr(const std::array<double, 3>& light) {
    return {std::pow(light[0], 1 / 2.4), std::pow(light[1], 1 / 2.4), std::pow(light[2], 1 / 2.4)};
}

TEST(VideoReader, OtherLightBecomesSrgb) {
    const TemporaryFolder folder;
    const std::array<std::array<int, 3>, 6> patches = {
        {{200, 60, 50}, {60, 190, 70}, {60, 80, 210}, {128, 128, 128}, {0, 0, 0}, {255, 255, 255}}};
    struct Kind {
        AVColorTransferCharacteristic transfer;
        std::array<double, 3> (*encode)(const std::array<double, 3>&);
        const char* word;
    };
    for (const Kind& kind :
         {Kind{AVCOL_TRC_ARIB_STD_B67, hlg, "HLG in BT.2020"}, Kind{AVCOL_TRC_SMPTE2084, pq, "PQ in BT.2020"},
          Kind{AVCOL_TRC_BT2020_10, sdr, "BT.2020"}}) {
        VideoFile video{{0}};
        video.encoder = "ffv1";
        video.format = AV_PIX_FMT_YUV444P10;
        video.transfer = kind.transfer;
        video.primaries = AVCOL_PRI_BT2020;
        video.matrix_of_colours = AVCOL_SPC_BT2020_NCL;
        video.width = 60;
        video.height = 10;
        video.paint = [&](AVFrame& frame, int) {
            for (int y = 0; y < frame.height; ++y)
                for (int x = 0; x < frame.width; ++x)
                    for (int plane = 0; plane < 3; ++plane)
                        reinterpret_cast<uint16_t*>(frame.data[plane] + y * frame.linesize[plane])[x] = yuv2020(
                            kind.encode(light2020(patches[static_cast<size_t>(x / 10)])))[static_cast<size_t>(plane)];
        };
        test::write_video_file(folder.path / "a.mkv", video);
        media::VideoReader reader(folder.path / "a.mkv");
        ASSERT_EQ(reader.notes().size(), 1u);
        EXPECT_NE(reader.notes()[0].find(kind.word), std::string::npos) << reader.notes()[0];
        media::Image frame;
        ASSERT_TRUE(reader.next(frame));
        for (uint32_t i = 0; i < 6; ++i)
            for (size_t c = 0; c < 3; ++c)
                EXPECT_NEAR(frame.at(10 * i + 5, 5)[c], patches[i][c], 3)
                    << kind.word << " patch " << i << " channel " << c;
    }
}

TEST(VideoColour, LinearLightIsEncodedAsSrgb) {
    const auto colour = media::VideoColour::of(AVCOL_TRC_LINEAR, AVCOL_PRI_BT709);
    ASSERT_TRUE(colour.has_value());
    for (int i = 0; i < 256; ++i) {
        const auto light = static_cast<uint16_t>(std::lround(65535 * media::linear_from_srgb(i / 255.0)));
        const uint16_t pixel[4] = {light, light, light, 65535};
        uint8_t srgb[4] = {};
        colour->to_srgb(pixel, srgb, 1);
        for (const uint8_t byte : {srgb[0], srgb[1], srgb[2]}) EXPECT_NEAR(byte, i, 1);
    }
}

// The primaries of SMPTE RP 431-2 and sRGB, and Bradford's matrix, give these numbers.
TEST(VideoColour, DciP3IsConverted) {
    const auto colour = media::VideoColour::of(AVCOL_TRC_BT709, AVCOL_PRI_SMPTE431);
    ASSERT_TRUE(colour.has_value());
    const std::pair<std::array<int, 3>, std::array<double, 3>> kPairs[] = {{{200, 100, 100}, {210.3, 92.2, 96.7}},
                                                                           {{100, 180, 90}, {76.2, 182.6, 75.6}},
                                                                           {{60, 80, 200}, {54.7, 79.6, 207.1}},
                                                                           {{255, 255, 255}, {255, 255, 255}}};
    for (const auto& [from, to] : kPairs) {
        uint16_t pixel[4] = {0, 0, 0, 65535};
        for (size_t c = 0; c < 3; ++c) pixel[c] = static_cast<uint16_t>(257 * from[c]);
        uint8_t srgb[4] = {};
        colour->to_srgb(pixel, srgb, 1);
        for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(srgb[c], to[c], 1);
    }
}

TEST(VideoColour, SaysWhatIsNotConverted) {
    const auto note = [](AVColorTransferCharacteristic transfer, AVColorPrimaries primaries, AVColorSpace matrix) {
        AVCodecParameters stream{};
        stream.color_trc = transfer;
        stream.color_primaries = primaries;
        stream.color_space = matrix;
        return media::colour_note(stream);
    };
    EXPECT_EQ(note(AVCOL_TRC_BT709, AVCOL_PRI_BT709, AVCOL_SPC_BT709), "");
    EXPECT_EQ(note(AVCOL_TRC_SMPTE170M, AVCOL_PRI_SMPTE170M, AVCOL_SPC_SMPTE170M), "");
    EXPECT_EQ(note(AVCOL_TRC_UNSPECIFIED, AVCOL_PRI_UNSPECIFIED, AVCOL_SPC_UNSPECIFIED), "");
    EXPECT_EQ(note(AVCOL_TRC_BT709, AVCOL_PRI_SMPTE431, AVCOL_SPC_BT709), "DCI-P3, converted to sRGB");
    EXPECT_EQ(note(AVCOL_TRC_BT709, AVCOL_PRI_SMPTE432, AVCOL_SPC_BT709), "Display P3, converted to sRGB");
    EXPECT_NE(note(AVCOL_TRC_LOG, AVCOL_PRI_BT709, AVCOL_SPC_BT709).find("transfer function log"), std::string::npos);
    for (const int matrix : {8, 11, 12, 13, 14})
        EXPECT_NE(note(AVCOL_TRC_BT709, AVCOL_PRI_BT709, static_cast<AVColorSpace>(matrix)).find("wrong"),
                  std::string::npos)
            << matrix;
    for (const int primaries : {4, 8, 10})
        EXPECT_NE(note(AVCOL_TRC_BT709, static_cast<AVColorPrimaries>(primaries), AVCOL_SPC_BT709).find("wrong"),
                  std::string::npos)
            << primaries;
}

TEST(VideoReader, SaysWhatItDoesNotApply) {
    const TemporaryFolder folder;
    VideoFile video{{0, 40}};
    video.pixel_aspect = {4, 3};
    video.encoder = "mjpeg";
    video.format = AV_PIX_FMT_YUVJ420P;
    video.fields = AV_FIELD_TT;
    test::write_video_file(folder.path / "a.mov", video);
    const media::VideoReader reader(folder.path / "a.mov");
    EXPECT_NEAR(reader.pixel_aspect(), 4.0 / 3, 1e-6);
    EXPECT_EQ(reader.size(), (media::ImageSize{64, 48}));
    const std::vector<std::string> notes = reader.notes();
    ASSERT_EQ(notes.size(), 2u);
    EXPECT_NE(notes[0].find("1.333 times as wide"), std::string::npos) << notes[0];
    EXPECT_NE(notes[1].find("interlaced"), std::string::npos) << notes[1];
}

// The same frames, some of which were dropped: the rate is that of the recording in every container.
TEST(VideoTimes, AreThoseOfTheFile) {
    const TemporaryFolder folder;
    for (const char* name : {"a.mp4", "a.mov", "a.mkv"}) {
        test::write_video_file(folder.path / name, {{0, 40, 120, 160, 240, 280}});
        const media::VideoTimes times = media::video_times(folder.path / name);
        ASSERT_EQ(times.shown_s.size(), 6u) << name;
        EXPECT_NEAR(times.shown_s[2], 0.12, 1e-6) << name;
        EXPECT_NEAR(times.shown_s[5], 0.28, 1e-6) << name;
        EXPECT_NEAR(times.fps, 25, 0.01) << name;
        EXPECT_FALSE(times.timecode_s.has_value());
    }
    VideoFile coded{{0, 40, 80}};
    coded.timecode = "01:00:02:05";
    test::write_video_file(folder.path / "a.mov", coded);
    EXPECT_NEAR(media::video_times(folder.path / "a.mov").timecode_s.value_or(0), 3602.2, 1e-6);
}

// Every frame of this rate but one, as `name`.
void write_without(const std::filesystem::path& path, AVRational time_base, int frames, int lacking,
                   VideoFile video = {}) {
    for (int i = 0; i < frames; ++i)
        if (i != lacking) video.times.push_back(i);
    video.time_base = time_base;
    video.rate = {time_base.den, time_base.num};
    video.width = video.height = 16;
    test::write_video_file(path, video);
}

// Of frames that lack, libav's average rate is less, and of an .avi, where a tick is a frame, it is all that shows
// them.
TEST(VideoTimes, OneLackingFrameIsAGap) {
    const TemporaryFolder folder;
    VideoFile h264;
    h264.encoder = "libx264";
    for (const auto& [name, video] : {std::pair{"a.mp4", VideoFile()},
                                      {"a.mkv", VideoFile()},
                                      {"a.avi", VideoFile()},
                                      {"b.avi", h264},
                                      {"b.mp4", h264}}) {
        write_without(folder.path / name, {1, 30}, 2500, 3, video);
        const media::VideoTimes times = media::video_times(folder.path / name);
        ASSERT_EQ(times.shown_s.size(), 2499u) << name;
        EXPECT_NEAR(times.fps, 30, 1e-9) << name;
        EXPECT_NEAR(times.shown_s[2] - times.shown_s[0], 2.0 / 30, 1.1e-3) << name;
        EXPECT_NEAR(times.shown_s[3] - times.shown_s[0], 4.0 / 30, 1.1e-3) << name;
        EXPECT_NEAR(times.shown_s[2498] - times.shown_s[0], 2499.0 / 30, 1.1e-3) << name;
    }
}

// Files of other containers than MP4, and what encodes their videos.
const std::pair<const char*, const char*> kContainers[] = {
    {"a.ts", "mpeg2video"}, {"a.m2ts", "libx264"},  {"a.mpg", "mpeg2video"}, {"a.mxf", "mpeg2video"},
    {"a.wmv", "wmv2"},      {"a.ogv", "libtheora"}, {"a.flv", "flv"}};

void write_container(const std::filesystem::path& path, const char* encoder) {
    VideoFile video{{0, 1, 2, 3, 4, 5, 6, 7}};
    video.time_base = {1, 25};
    video.encoder = encoder;
    test::write_video_file(path, video);
}

// Cameras write .mts, and studios .mxf. Where a clock runs on from file to file, times begin anew.
TEST(VideoTimes, OtherContainersAreRead) {
    const TemporaryFolder folder;
    for (const auto& [name, encoder] : kContainers) {
        write_container(folder.path / name, encoder);
        media::VideoReader reader(folder.path / name);
        EXPECT_EQ(reader.frames(), 8u) << name;
        media::Image frame;
        int count = 0;
        while (reader.next(frame)) ++count;
        EXPECT_EQ(count, 8) << name;
        const media::VideoTimes times = media::video_times(folder.path / name);
        ASSERT_EQ(times.shown_s.size(), 8u) << name;
        EXPECT_NEAR(times.shown_s[0], 0, 1e-6) << name;
        EXPECT_NEAR(times.shown_s[7], 7.0 / 25, 1.1e-3) << name;
        EXPECT_NEAR(times.fps, 25, 1e-6) << name;
    }
}

TEST(VideoTimes, DamagedContainersDoNoHarm) {
    const TemporaryFolder folder;
    std::mt19937 random(5);
    for (const auto& [name, encoder] : kContainers) {
        write_container(folder.path / name, encoder);
        const std::string whole = read_text(folder.path / name);
        for (int round = 0; round < 20; ++round) {
            std::string bytes = whole;
            for (int i = 0; i < 8; ++i) bytes[random() % bytes.size()] = static_cast<char>(random());
            write_text(folder.path / name, bytes);
            try {
                media::video_times(folder.path / name);
                media::VideoReader reader(folder.path / name);
                media::Image frame;
                while (reader.next(frame)) ASSERT_EQ(frame.rgba.size(), size_t{4} * frame.width * frame.height);
            } catch (const InputError& error) {
                EXPECT_NE(std::string(error.what()).find(name), std::string::npos);
            }
        }
    }
}

TEST(VideoTimes, FastFramesMayBeRoundedToMilliseconds) {
    const TemporaryFolder folder;
    for (const int fps : {240, 480, 900}) {
        write_without(folder.path / "a.mkv", {1, fps}, 500, 100);
        EXPECT_NEAR(media::video_times(folder.path / "a.mkv").fps, fps, 1e-6);
        std::vector<double> times;
        for (int i = 0; i < 1000; ++i) times.push_back(std::round(1000.0 * i / fps) / 1000);
        EXPECT_NEAR(media::rate_of(times, 1e-3), fps, fps * 1e-3);
    }
}

TEST(VideoTimes, TheRateIsThatOfMostFrames) {
    EXPECT_EQ(media::rate_of({}), 0);
    EXPECT_EQ(media::rate_of({1}), 0);
    EXPECT_EQ(media::rate_of({1, 1, 1}), 0);
    EXPECT_NEAR(media::rate_of({0, 0.02, 0.04, 0.1, 0.12}), 50, 1e-9);
    EXPECT_NEAR(media::rate_of({0, 0.033, 0.067, 0.1, 0.133, 0.167, 0.2}), 30, 1e-9) << "rounded to milliseconds";
}

}  // namespace
}  // namespace neuvv
