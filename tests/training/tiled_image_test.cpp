// Tiles of an image give back its pixels, and only foreground takes memory.
#include "training/data/tiled_image.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <set>

namespace neuvv {
namespace {

using training::TiledImage;

constexpr uint64_t kGroupBytes = sizeof(TiledImage::Group);

// Sizes on, just before and just beyond the edges of tiles, and with more and fewer tiles than a group has.
constexpr std::array<std::pair<uint32_t, uint32_t>, 9> kSizes = {
    {{1, 1}, {8, 8}, {7, 9}, {9, 7}, {64, 64}, {65, 63}, {131, 203}, {600, 1}, {1, 600}}};

media::Image noise(uint32_t width, uint32_t height, std::mt19937& random) {
    media::Image image(width, height);
    for (uint8_t& value : image.rgba) value = static_cast<uint8_t>(random());
    return image;
}

uint32_t below(uint32_t end, std::mt19937& random) {
    return static_cast<uint32_t>(random() % end);
}

// Clears alpha in random rectangles, and leaves colours under it.
void clear_rectangles(media::Image& image, std::mt19937& random) {
    for (uint32_t i = below(6, random); i > 0; --i) {
        const uint32_t left = below(image.width, random), top = below(image.height, random);
        const uint32_t right = left + 1 + below(image.width - left, random),
                       bottom = top + 1 + below(image.height - top, random);
        for (uint32_t y = top; y < bottom; ++y)
            for (uint32_t x = left; x < right; ++x) image.at(x, y)[3] = 0;
    }
}

// The image with 0 0 0 0 wherever alpha is 0.
media::Image without_hidden_colours(media::Image image) {
    for (size_t i = 0; i < image.rgba.size(); i += 4)
        if (image.rgba[i + 3] == 0) std::fill_n(&image.rgba[i], 4, uint8_t{0});
    return image;
}

std::set<std::pair<uint32_t, uint32_t>> tiles_with_foreground(const media::Image& image) {
    std::set<std::pair<uint32_t, uint32_t>> tiles;
    for (uint32_t y = 0; y < image.height; ++y)
        for (uint32_t x = 0; x < image.width; ++x)
            if (image.at(x, y)[3] > 0) tiles.insert({x / 8, y / 8});
    return tiles;
}

void expect_holds(const TiledImage& tiled, const media::Image& image) {
    const media::Image expected = without_hidden_colours(image);
    ASSERT_EQ(tiled.width(), image.width);
    ASSERT_EQ(tiled.height(), image.height);
    for (uint32_t y = 0; y < image.height; ++y)
        for (uint32_t x = 0; x < image.width; ++x)
            ASSERT_TRUE(std::equal(tiled.at(x, y), tiled.at(x, y) + 4, expected.at(x, y))) << x << " " << y;
    EXPECT_EQ(tiled.whole().rgba, expected.rgba);

    const auto tiles = tiles_with_foreground(image);
    for (uint32_t y = 0; y < tiled.tiles_down(); ++y)
        for (uint32_t x = 0; x < tiled.tiles_across(); ++x)
            ASSERT_EQ(tiled.has_tile(x, y), tiles.contains({x, y})) << x << " " << y;
    EXPECT_EQ(tiled.tile_count(), tiles.size());
    const uint64_t all_tiles = uint64_t{(image.width + 7) / 8} * ((image.height + 7) / 8);
    EXPECT_EQ(tiled.bytes(), tiles.size() * 256 + (all_tiles + 63) / 64 * kGroupBytes);
    EXPECT_LE(tiled.bytes(), TiledImage::max_bytes(image.width, image.height));

    media::Image visited(image.width, image.height);
    size_t visits = 0;
    tiled.for_each_kept([&](uint32_t x, uint32_t y, const uint8_t* rgba) {
        std::copy_n(rgba, 4, visited.at(x, y));
        ++visits;
    });
    EXPECT_EQ(visited.rgba, expected.rgba);
    EXPECT_LE(visits, tiles.size() * 64);
}

TEST(TiledImage, GivesBackPixelsOfRandomMattes) {
    std::mt19937 random(1);
    for (const auto& [width, height] : kSizes)
        for (int i = 0; i < 12; ++i) {
            SCOPED_TRACE(testing::Message() << width << "x" << height << " " << i);
            media::Image image = noise(width, height, random);
            clear_rectangles(image, random);
            expect_holds(TiledImage(image), image);
        }
}

TEST(TiledImage, KeepsNoTileOfAnEmptyImage) {
    std::mt19937 random(2);
    for (const auto& [width, height] : kSizes) {
        media::Image image = noise(width, height, random);
        for (size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 0;
        const TiledImage tiled(image);
        expect_holds(tiled, image);
        EXPECT_EQ(tiled.tile_count(), 0u);
        EXPECT_EQ(tiled, TiledImage(media::Image(width, height))) << "colours under alpha 0 are not kept";
    }
    EXPECT_EQ(TiledImage(media::Image()).bytes(), 0u);
    EXPECT_EQ(TiledImage().whole().width, 0u);
}

// Footage without mattes: every pixel counts.
TEST(TiledImage, AFullImageTakesHardlyMoreThanItsPixels) {
    std::mt19937 random(3);
    for (const auto& [width, height] : kSizes) {
        media::Image image = noise(width, height, random);
        for (size_t i = 3; i < image.rgba.size(); i += 4) image.rgba[i] = 255;
        const TiledImage tiled(image);
        expect_holds(tiled, image);
        EXPECT_EQ(tiled.bytes(), TiledImage::max_bytes(width, height));
    }
    EXPECT_EQ(TiledImage::max_bytes(960, 544), 960 * 544 * 4 + 128 * kGroupBytes);
    EXPECT_EQ(TiledImage::max_bytes(960, 540), TiledImage::max_bytes(960, 544)) << "rows up to a whole tile";
}

TEST(TiledImage, ASinglePixelOfAnyAlphaKeepsItsTile) {
    for (const auto& [width, height] : kSizes) {
        media::Image image(width, height);
        std::fill_n(image.at(width - 1, height - 1), 4, uint8_t{1});
        const TiledImage tiled(image);
        expect_holds(tiled, image);
        EXPECT_EQ(tiled.tile_count(), 1u);
    }
}

// A resource that hands out memory a given number of times.
class Limited : public std::pmr::memory_resource {
  public:
    int left = 2;

  private:
    void* do_allocate(size_t bytes, size_t alignment) override {
        if (left-- <= 0) throw std::bad_alloc();
        return std::pmr::new_delete_resource()->allocate(bytes, alignment);
    }
    void do_deallocate(void* at, size_t bytes, size_t alignment) override {
        std::pmr::new_delete_resource()->deallocate(at, bytes, alignment);
    }
    bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override { return this == &other; }
};

TEST(TiledImage, FewerTilesTakeThePlaceOfMore) {
    std::mt19937 random(4);
    Limited memory;
    TiledImage tiled(&memory);
    media::Image image = noise(131, 203, random);
    tiled.store(image);
    EXPECT_EQ(memory.left, 0) << "two arrays";
    for (int i = 0; i < 5; ++i) {
        clear_rectangles(image, random);
        ASSERT_NO_THROW(tiled.store(image));
        expect_holds(tiled, image);
    }
    EXPECT_THROW(tiled.store(noise(400, 400, random)), std::bad_alloc);
}

TEST(TiledImage, ACopyIsAsGoodAndEqual) {
    std::mt19937 random(5);
    media::Image image = noise(65, 63, random);
    clear_rectangles(image, random);
    const TiledImage tiled(image);
    TiledImage copy = tiled;
    EXPECT_EQ(copy, tiled);
    image.at(40, 40)[3] ^= 0xff;
    copy.store(image);
    EXPECT_NE(copy, tiled);
}

}  // namespace
}  // namespace neuvv
