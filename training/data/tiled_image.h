// An image of which only the tiles with foreground are kept.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <memory_resource>
#include <vector>

#include "media/image.h"

namespace neuvv::training {

// Tiles of 8×8 pixels with any alpha above 0 lie one after the other, row by row; the others take one bit each. Most of
// what a camera of a capture sees is background, so that a data set takes a fraction of its pixels' size. An image
// without background takes 0.1 % more than its pixels, and what fills up the tiles at its right and lower edge.
class TiledImage {
  public:
    static constexpr uint32_t kSide = 8;  // pixels
    static constexpr size_t kTileBytes = size_t{4} * kSide * kSide;

    TiledImage() = default;
    explicit TiledImage(std::pmr::memory_resource* memory) : groups_(memory), rgba_(memory) {}
    explicit TiledImage(const media::Image& image) { store(image); }

    // Replaces the image. Where the new one has no more tiles than the old one, no memory is allocated.
    void store(const media::Image& image);

    uint32_t width() const { return width_; }
    uint32_t height() const { return height_; }
    uint32_t tiles_across() const { return tiles_along(width_); }
    uint32_t tiles_down() const { return tiles_along(height_); }

    // Whether any pixel of a tile has alpha above 0. x and y count tiles.
    bool has_tile(uint32_t x, uint32_t y) const {
        const size_t tile = size_t{y} * tiles_across() + x;
        return groups_[tile / 64].kept >> tile % 64 & 1;
    }

    size_t tile_count() const { return rgba_.size() / kTileBytes; }  // those that are kept

    // RGBA of a pixel; 0 0 0 0 where its alpha is 0.
    const uint8_t* at(uint32_t x, uint32_t y) const {
        static constexpr uint8_t kClear[4] = {};
        const size_t tile = size_t{y / kSide} * tiles_across() + x / kSide;
        const Group& group = groups_[tile / 64];
        const uint64_t bit = uint64_t{1} << tile % 64;
        if ((group.kept & bit) == 0) return kClear;
        const size_t before = group.before + static_cast<size_t>(std::popcount(group.kept & (bit - 1)));
        return &rgba_[before * kTileBytes + size_t{4} * (y % kSide * kSide + x % kSide)];
    }

    // Calls visit(x, y, rgba) for the pixels of all kept tiles, tile by tile: faster than to ask for every pixel.
    template <typename Visit>
    void for_each_kept(const Visit& visit) const {
        const uint8_t* tile = rgba_.data();
        for (uint32_t top = 0; top < height_; top += kSide)
            for (uint32_t left = 0; left < width_; left += kSide) {
                if (!has_tile(left / kSide, top / kSide)) continue;
                for (uint32_t y = 0; y < std::min(kSide, height_ - top); ++y)
                    for (uint32_t x = 0; x < std::min(kSide, width_ - left); ++x)
                        visit(left + x, top + y, tile + size_t{4} * (y * kSide + x));
                tile += kTileBytes;
            }
    }

    // All pixels, those of alpha 0 as 0 0 0 0.
    media::Image whole() const;

    // 64 neighbouring tiles, the first in the lowest bit, and how many kept tiles come before them.
    struct Group {
        uint64_t kept = 0, before = 0;
        bool operator==(const Group&) const = default;
    };
    const std::pmr::vector<Group>& groups() const { return groups_; }
    const std::pmr::vector<uint8_t>& kept_rgba() const { return rgba_; }

    // What this image takes, and what one of a size takes at most.
    uint64_t bytes() const { return groups_.size() * sizeof(Group) + rgba_.size(); }
    static uint64_t max_bytes(uint32_t width, uint32_t height);

    bool operator==(const TiledImage&) const = default;

  private:
    static uint32_t tiles_along(uint32_t pixels) { return (pixels + kSide - 1) / kSide; }
    static size_t group_count(uint32_t width, uint32_t height) {
        return (size_t{tiles_along(width)} * tiles_along(height) + 63) / 64;
    }
    void find_tiles(const media::Image& image);

    uint32_t width_ = 0, height_ = 0;
    std::pmr::vector<Group> groups_;
    std::pmr::vector<uint8_t> rgba_;
};

}  // namespace neuvv::training
