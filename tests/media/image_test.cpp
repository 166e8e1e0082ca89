#include "media/image.h"

#include <gtest/gtest.h>
#include <jpeglib.h>
#include <png.h>

#include <cmath>
#include <cstdlib>
#include <random>

#include "base/platform.h"
#include "support/input_error.h"
#include "support/temporary_folder.h"

namespace neuvv {
namespace {

media::Image random_image(uint32_t width, uint32_t height, bool opaque) {
    std::mt19937 random(width * 1000 + height);
    media::Image image(width, height);
    for (size_t i = 0; i < image.rgba.size(); ++i)
        image.rgba[i] = opaque && i % 4 == 3 ? 255 : static_cast<uint8_t>(random());
    return image;
}

// Writes a PNG of any kind, row by row as libpng takes them.
struct PngKind {
    uint32_t width, height;
    int depth, colour;
    bool interlaced = false;
    std::vector<png_color> palette = {};
    std::vector<uint8_t> palette_alpha = {};
    double gamma = 0;
};

void write_png_kind(const std::filesystem::path& path, const PngKind& kind, std::vector<std::vector<uint8_t>> rows) {
    FILE* file = std::fopen(path.c_str(), "wb");
    ASSERT_NE(file, nullptr);
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_set_IHDR(png, info, kind.width, kind.height, kind.depth, kind.colour,
                 kind.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, 0, 0);
    if (!kind.palette.empty()) png_set_PLTE(png, info, kind.palette.data(), static_cast<int>(kind.palette.size()));
    if (!kind.palette_alpha.empty())
        png_set_tRNS(png, info, kind.palette_alpha.data(), static_cast<int>(kind.palette_alpha.size()), nullptr);
    if (kind.gamma > 0) png_set_gAMA(png, info, kind.gamma);
    std::vector<png_bytep> pointers;
    for (auto& row : rows) pointers.push_back(row.data());
    png_set_rows(png, info, pointers.data());
    png_write_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
    png_destroy_write_struct(&png, &info);
    std::fclose(file);
}

void expect_pixel(const media::Image& image, uint32_t x, uint32_t y, std::array<int, 4> expected) {
    for (size_t c = 0; c < 4; ++c) EXPECT_EQ(image.at(x, y)[c], expected[c]) << x << ',' << y << " channel " << c;
}

std::vector<uint8_t> encode_jpeg(const media::Image& image, int quality) {
    jpeg_compress_struct jpeg{};
    jpeg_error_mgr errors{};
    jpeg.err = jpeg_std_error(&errors);
    jpeg_create_compress(&jpeg);
    unsigned char* bytes = nullptr;
    unsigned long size = 0;
    jpeg_mem_dest(&jpeg, &bytes, &size);
    jpeg.image_width = image.width;
    jpeg.image_height = image.height;
    jpeg.input_components = 4;
    jpeg.in_color_space = JCS_EXT_RGBX;
    jpeg_set_defaults(&jpeg);
    jpeg_set_quality(&jpeg, quality, TRUE);
    jpeg_start_compress(&jpeg, TRUE);
    while (jpeg.next_scanline < jpeg.image_height) {
        JSAMPROW row = const_cast<uint8_t*>(image.at(0, jpeg.next_scanline));
        jpeg_write_scanlines(&jpeg, &row, 1);
    }
    jpeg_finish_compress(&jpeg);
    std::vector<uint8_t> result(bytes, bytes + size);
    jpeg_destroy_compress(&jpeg);
    std::free(bytes);
    return result;
}

TEST(Image, TransferFunctionIsThatOfSrgb) {
    EXPECT_NEAR(media::srgb_from_linear(0.5), 0.735357, 1e-6);
    EXPECT_NEAR(media::srgb_from_linear(0.001), 0.01292, 1e-9);
    EXPECT_NEAR(media::linear_from_srgb(0.5), 0.214041, 1e-6);
    EXPECT_NEAR(media::linear_from_srgb(1), 1, 1e-12);
    for (int i = 0; i <= 255; ++i)
        EXPECT_NEAR(media::srgb_from_linear(media::linear_from_srgb(i / 255.0)), i / 255.0, 1e-6);
}

TEST(Image, PngRoundTripIsExact) {
    const TemporaryFolder folder;
    for (const bool opaque : {false, true}) {
        const media::Image image = random_image(37, 11, opaque);
        media::write_png(folder.path / "a.png", image);
        const media::Image back = media::read_png(folder.path / "a.png");
        EXPECT_EQ(back.width, 37u);
        EXPECT_EQ(back.height, 11u);
        EXPECT_EQ(back.rgba, image.rgba);
        const std::string bytes = read_text(folder.path / "a.png");
        EXPECT_EQ(bytes[25], opaque ? PNG_COLOR_TYPE_RGB : PNG_COLOR_TYPE_RGBA);
        EXPECT_NE(bytes.find("sRGB"), std::string::npos);
    }
    EXPECT_EQ(folder.entries(), 1u) << "a temporary file stayed";
}

TEST(Image, ImagesWithoutColourBecomeGreyPngs) {
    const TemporaryFolder folder;
    media::Image image = random_image(37, 11, true);
    for (size_t i = 0; i < image.rgba.size(); i += 4) image.rgba[i + 1] = image.rgba[i + 2] = image.rgba[i];
    media::write_png(folder.path / "grey.png", image);
    EXPECT_EQ(media::read_png(folder.path / "grey.png").rgba, image.rgba);
    EXPECT_EQ(read_text(folder.path / "grey.png")[25], PNG_COLOR_TYPE_GRAY);
    image.rgba[image.rgba.size() - 2] ^= 1;  // the last pixel's blue
    media::write_png(folder.path / "blueish.png", image);
    EXPECT_EQ(media::read_png(folder.path / "blueish.png").rgba, image.rgba);
    EXPECT_EQ(read_text(folder.path / "blueish.png")[25], PNG_COLOR_TYPE_RGB);
}

TEST(Image, WritingWhereThereIsNoFolderFails) {
    const TemporaryFolder folder;
    EXPECT_THROW(media::write_png(folder.path / "none" / "a.png", random_image(4, 4, true)), RuntimeFailure);
}

TEST(Image, PngOf16BitGreyIsScaledWithoutGamma) {
    const TemporaryFolder folder;
    const auto path = folder.path / "grey16.png";
    // 0x80ff is 128.99 of 255 in exact proportion; a gamma of 1 in the file must change nothing.
    write_png_kind(path, {.width = 3, .height = 1, .depth = 16, .colour = PNG_COLOR_TYPE_GRAY, .gamma = 1.0},
                   {{0x00, 0x00, 0x80, 0xff, 0xff, 0xff}});
    const media::Image image = media::read_png(path);
    expect_pixel(image, 0, 0, {0, 0, 0, 255});
    expect_pixel(image, 1, 0, {128, 128, 128, 255});
    expect_pixel(image, 2, 0, {255, 255, 255, 255});
}

TEST(Image, PngOf1BitGreyAndPaletteAreWidened) {
    const TemporaryFolder folder;
    const auto path = folder.path / "kind.png";
    write_png_kind(path, {.width = 3, .height = 1, .depth = 1, .colour = PNG_COLOR_TYPE_GRAY}, {{0xa0}});
    expect_pixel(media::read_png(path), 0, 0, {255, 255, 255, 255});
    expect_pixel(media::read_png(path), 1, 0, {0, 0, 0, 255});
    write_png_kind(path,
                   {.width = 2,
                    .height = 1,
                    .depth = 8,
                    .colour = PNG_COLOR_TYPE_PALETTE,
                    .palette = {{10, 20, 30}, {40, 50, 60}},
                    .palette_alpha = {7}},
                   {{1, 0}});
    expect_pixel(media::read_png(path), 0, 0, {40, 50, 60, 255});
    expect_pixel(media::read_png(path), 1, 0, {10, 20, 30, 7});
}

TEST(Image, InterlacedPngIsWhole) {
    const TemporaryFolder folder;
    const media::Image image = random_image(19, 13, false);
    std::vector<std::vector<uint8_t>> rows;
    for (uint32_t y = 0; y < 13; ++y) rows.emplace_back(image.at(0, y), image.at(0, y) + 4 * 19);
    write_png_kind(folder.path / "i.png",
                   {.width = 19, .height = 13, .depth = 8, .colour = PNG_COLOR_TYPE_RGBA, .interlaced = true}, rows);
    EXPECT_EQ(media::read_png(folder.path / "i.png").rgba, image.rgba);
}

TEST(Image, EveryTruncationOfAPngIsRefused) {
    const TemporaryFolder folder;
    media::write_png(folder.path / "whole.png", random_image(9, 9, false));
    const std::string bytes = read_text(folder.path / "whole.png");
    for (size_t size = 0; size < bytes.size(); ++size)
        expect_input_error(
            [&] { media::decode_image(reinterpret_cast<const uint8_t*>(bytes.data()), size, "cut.png"); }, {"cut.png"});
}

TEST(Image, EveryDamagedByteIsRefusedOrHarmless) {
    const TemporaryFolder folder;
    media::write_png(folder.path / "whole.png", random_image(9, 9, false));
    const std::vector<uint8_t> whole = read_file(folder.path / "whole.png");
    size_t refused = 0;
    for (size_t i = 0; i < whole.size(); ++i) {
        std::vector<uint8_t> bytes = whole;
        bytes[i] ^= 0x5a;
        try {
            EXPECT_EQ(media::decode_image(bytes.data(), bytes.size(), "d.png").rgba.size(), 4u * 9 * 9);
        } catch (const InputError&) {
            ++refused;
        }
    }
    EXPECT_GT(refused, whole.size() * 9 / 10);  // all except damage in chunks that libpng may skip
}

TEST(Image, BadSizesAreRefusedBeforeMemoryIsTaken) {
    const TemporaryFolder folder;
    media::write_png(folder.path / "a.png", random_image(9, 9, false));
    std::string bytes = read_text(folder.path / "a.png");
    const auto with_width = [&](uint32_t width) {
        for (size_t i = 0; i < 4; ++i) bytes[16 + i] = static_cast<char>(width >> (24 - 8 * i));
        write_text(folder.path / "b.png", bytes);
        return folder.path / "b.png";
    };
    expect_input_error([&] { media::read_png(with_width(0)); }, {"b.png", "zero size"});
    expect_input_error([&] { media::read_png(with_width(media::kMaxImageSide + 1)); }, {"b.png", "16385"});
    expect_input_error([&] { media::read_png(with_width(0xffffffff)); }, {"b.png", "4294967295"});
    bytes[20] = 0, bytes[21] = 0, bytes[22] = 0x40, bytes[23] = 0;
    const uint64_t before = peak_memory_bytes();
    expect_input_error([&] { media::read_png(with_width(media::kMaxImageSide)); }, {"b.png", "16384×16384 in"});
    expect_input_error(
        [&] { media::decode_image(reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size(), "b.png"); },
        {"b.png", "cannot hold 16384×16384"});
    EXPECT_LT(peak_memory_bytes() - before, uint64_t{64} << 20);
}

// One bit a pixel, all alike: the smallest file of its size.
TEST(Image, ManyPixelsOfNothingAreRefusedBeforeMemoryIsTaken) {
    const TemporaryFolder folder;
    const uint32_t side = 8192;
    write_png_kind(folder.path / "b.png", {side, side, 1, PNG_COLOR_TYPE_GRAY},
                   std::vector(side, std::vector<uint8_t>(side / 8)));
    EXPECT_LT(std::filesystem::file_size(folder.path / "b.png"), 20'000u);
    const uint64_t before = peak_memory_bytes();
    expect_input_error([&] { media::read_png(folder.path / "b.png"); }, {"b.png", "8192×8192 in", "scale it down"});
    EXPECT_LT(peak_memory_bytes() - before, uint64_t{64} << 20);
    media::expect_content({4096, 4096}, 1, "a mask");
    media::expect_content({14204, 10652}, 2'000'000, "a photograph");
}

TEST(Image, WhatIsNoImageIsNamed) {
    const TemporaryFolder folder;
    expect_input_error([&] { media::read_png(folder.path / "none.png"); }, {"none.png", "No such file"});
    write_text(folder.path / "text.png", "GIF89a and so on");
    expect_input_error([&] { media::read_png(folder.path / "text.png"); }, {"text.png", "neither a PNG nor a JPEG"});
    write_text(folder.path / "empty.png", "");
    expect_input_error([&] { media::read_png(folder.path / "empty.png"); }, {"empty.png", "empty"});
}

TEST(Image, JpegIsDecodedOpaque) {
    media::Image image(32, 16);
    for (uint32_t y = 0; y < 16; ++y)
        for (uint32_t x = 0; x < 32; ++x) {
            const uint8_t colour[4] = {200, static_cast<uint8_t>(8 * x), 40, 0};
            std::copy(colour, colour + 4, image.at(x, y));
        }
    const std::vector<uint8_t> bytes = encode_jpeg(image, 95);
    const media::Image back = media::decode_image(bytes.data(), bytes.size(), "a.jpg");
    ASSERT_EQ(back.width, 32u);
    ASSERT_EQ(back.height, 16u);
    for (uint32_t x = 0; x < 32; ++x) {
        for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(back.at(x, 8)[c], image.at(x, 8)[c], 12);
        EXPECT_EQ(back.at(x, 8)[3], 255);
    }
    for (size_t size = 0; size + 2 < bytes.size(); ++size)  // the last two bytes are only the end mark
        expect_input_error([&] { media::decode_image(bytes.data(), size, "cut.jpg"); }, {"cut.jpg"});
}

TEST(Image, CompositeBlendsEncodedValues) {
    media::Image image(3, 1);
    const uint8_t pixels[12] = {100, 0, 255, 128, 9, 9, 9, 0, 9, 9, 9, 255};
    std::copy(pixels, pixels + 12, image.rgba.begin());
    const uint8_t background[3] = {255, 100, 0};
    const media::Image over = media::composite_over(image, background);
    expect_pixel(over, 0, 0, {177, 50, 128, 255});  // 255 − 155·128/255 = 177.2; 100·127/255 = 49.8
    expect_pixel(over, 1, 0, {255, 100, 0, 255});
    expect_pixel(over, 2, 0, {9, 9, 9, 255});
}

}  // namespace
}  // namespace neuvv
