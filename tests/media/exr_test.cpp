// Writing and reading OpenEXR.
#include "media/exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/error.h"
#include "media/image.h"
#include "support/input_error.h"
#include "support/temporary_folder.h"

namespace neuvv {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

media::LinearImage gradient(uint32_t width, uint32_t height) {
    media::LinearImage image{width, height};
    for (uint32_t y = 0; y < height; ++y)
        for (uint32_t x = 0; x < width; ++x) {
            const float alpha = static_cast<float>(x) / static_cast<float>(width);
            for (const float colour : {3.0f, 0.01f, -0.5f}) image.rgba.push_back(alpha * colour);
            image.rgba.push_back(alpha);
            image.depth_m.push_back(x == 0 ? kInfinity : 1.2345678f + static_cast<float>(y));
        }
    return image;
}

TEST(Exr, RoundTrips) {
    const TemporaryFolder folder;
    const media::LinearImage image = gradient(37, 21);
    media::write_exr(folder.path / "a.exr", image);
    EXPECT_EQ(folder.entries(), 1u);
    const media::LinearImage back = media::read_exr(folder.path / "a.exr");
    ASSERT_EQ(back.width, 37u);
    ASSERT_EQ(back.height, 21u);
    ASSERT_EQ(back.rgba.size(), image.rgba.size());
    bool exact = true;
    for (size_t i = 0; i < image.rgba.size(); ++i) {  // half a step of a half, which has 11 bits
        EXPECT_NEAR(back.rgba[i], image.rgba[i], std::abs(image.rgba[i]) / 2048 + 1e-7) << i;
        exact = exact && back.rgba[i] == image.rgba[i];
    }
    EXPECT_FALSE(exact) << "colours are halves";
    EXPECT_EQ(back.depth_m, image.depth_m) << "depth is float";
    media::write_exr(folder.path / "b.exr", image);
    EXPECT_EQ(read_text(folder.path / "a.exr"), read_text(folder.path / "b.exr"));
}

TEST(Exr, TheFileIsWhatOthersExpect) {
    const TemporaryFolder folder;
    media::LinearImage image = gradient(8, 4);
    image.pixel_aspect = 2;
    media::write_exr(folder.path / "a.exr", image);
    const Imf::InputFile file((folder.path / "a.exr").c_str());
    const Imf::Header& header = file.header();
    EXPECT_EQ(header.pixelAspectRatio(), 2);
    EXPECT_EQ(header.compression(), Imf::ZIP_COMPRESSION);
    for (const char* name : {"R", "G", "B", "A"}) {
        ASSERT_TRUE(header.channels().findChannel(name)) << name;
        EXPECT_EQ(header.channels().findChannel(name)->type, Imf::HALF);
    }
    EXPECT_EQ(header.channels().findChannel("Z")->type, Imf::FLOAT);
    EXPECT_EQ(media::read_exr(folder.path / "a.exr").pixel_aspect, 2);
    image.depth_m.clear();
    media::write_exr(folder.path / "b.exr", image);
    EXPECT_FALSE(Imf::InputFile((folder.path / "b.exr").c_str()).header().channels().findChannel("Z"));
    EXPECT_TRUE(media::read_exr(folder.path / "b.exr").depth_m.empty());
}

TEST(Exr, BrightLightIsClampedToWhatAHalfHolds) {
    const TemporaryFolder folder;
    media::LinearImage image{1, 1, {1e9f, -1e9f, 65504, 1}};
    media::write_exr(folder.path / "a.exr", image);
    EXPECT_EQ(media::read_exr(folder.path / "a.exr").rgba, (std::vector<float>{65504, -65504, 65504, 1}));
}

// Files as other programs write them: floats, RGB alone, a data window that does not begin at 0.
TEST(Exr, FilesOfOthersAreRead) {
    const TemporaryFolder folder;
    const std::string path = (folder.path / "env.exr").string();
    std::vector<float> values;
    for (int i = 0; i < 3 * 3 * 2; ++i) values.push_back(static_cast<float>(i) / 8);
    const auto write = [&](const char* first) {
        const Imath::Box2i window(Imath::V2i(5, -7), Imath::V2i(7, -6));
        Imf::Header header(window, window);
        header.compression() = Imf::PIZ_COMPRESSION;
        Imf::FrameBuffer pixels;
        for (size_t c = 0; c < 3; ++c) {
            const char* names[] = {first, "G", "B"};
            header.channels().insert(names[c], Imf::Channel(Imf::FLOAT));
            pixels.insert(names[c], Imf::Slice::Make(Imf::FLOAT, values.data() + c, window, 12, 36));
        }
        Imf::OutputFile file(path.c_str(), header);
        file.setFrameBuffer(pixels);
        file.writePixels(2);
    };
    write("R");
    const media::LinearImage image = media::read_exr(path);
    ASSERT_EQ(image.width, 3u);
    ASSERT_EQ(image.height, 2u);
    for (size_t pixel = 0; pixel < 6; ++pixel) {
        for (size_t c = 0; c < 3; ++c) EXPECT_EQ(image.rgba[4 * pixel + c], values[3 * pixel + c]);
        EXPECT_EQ(image.rgba[4 * pixel + 3], 1);
    }
    values[4] = kInfinity;
    write("R");
    expect_input_error([&] { media::read_exr(path); }, {"env.exr", "pixel 1, 0", "finite"});
    write("L");
    expect_input_error([&] { media::read_exr(path); }, {"env.exr", "no R"});
}

TEST(Exr, HostileSizesAreRefused) {
    const TemporaryFolder folder;
    const std::string path = (folder.path / "bomb.exr").string();
    const auto expect_refused_window = [&](int width, int height) {
        const Imath::Box2i window(Imath::V2i(0, 0), Imath::V2i(width - 1, height - 1));
        Imf::Header header(window, window);
        header.compression() = Imf::ZIP_COMPRESSION;
        for (const char* name : {"R", "G", "B"}) header.channels().insert(name, Imf::Channel(Imf::HALF));
        { const Imf::OutputFile written(path.c_str(), header); }  // the header and a table of lines, no pixels
        expect_input_error([&] { media::read_exr(path); }, {"bomb.exr"});
    };
    Imf::Header::setMaxImageSize(0, 0);
    expect_refused_window(20000, 10);
    Imf::Header::setMaxImageSize(0, 0);
    expect_refused_window(10, 20000);
    Imf::Header::setMaxImageSize(0, 0);
    expect_refused_window(16384, 16384);
}

TEST(Exr, DamageIsNamed) {
    const TemporaryFolder folder;
    media::write_exr(folder.path / "a.exr", gradient(40, 30));
    const std::string whole = read_text(folder.path / "a.exr");
    const auto path = folder.path / "bad.exr";
    expect_input_error([&] { media::read_exr(folder.path / "none.exr"); }, {"none.exr", "cannot open"});
    for (const size_t size : {size_t{0}, size_t{3}, size_t{100}, whole.size() / 2, whole.size() - 1}) {
        write_text(path, whole.substr(0, size));
        expect_input_error([&] { media::read_exr(path); }, {"bad.exr"});
    }
    uint32_t state = 7;
    for (int round = 0; round < 200; ++round) {  // must give an InputError or a sound image, nothing else
        std::string bytes = whole;
        for (int i = 0; i < 6; ++i) {
            state = state * 1664525 + 1013904223;
            const size_t span = round % 2 ? bytes.size() : 400;  // in the header, or anywhere
            bytes[(state >> 8) % span] = static_cast<char>(state);
        }
        write_text(path, bytes);
        try {
            const media::LinearImage image = media::read_exr(path);
            EXPECT_EQ(image.rgba.size(), size_t{4} * image.width * image.height);
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("bad.exr"), std::string::npos);
        }
    }
}

TEST(Exr, AnUnwritablePlaceFails) {
    const TemporaryFolder folder;
    EXPECT_THROW(media::write_exr(folder.path / "no/such/a.exr", gradient(2, 2)), RuntimeFailure);
}

}  // namespace
}  // namespace neuvv
