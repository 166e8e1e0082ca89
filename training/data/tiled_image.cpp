#include "training/data/tiled_image.h"

namespace neuvv::training {

void TiledImage::store(const media::Image& image) {
    width_ = image.width;
    height_ = image.height;
    find_tiles(image);
    const size_t kept = groups_.empty() ? 0 : groups_.back().before + std::popcount(groups_.back().kept);
    rgba_.assign(kept * kTileBytes, 0);
    uint8_t* to = rgba_.data();
    for (uint32_t top = 0; top < height_; top += kSide)
        for (uint32_t left = 0; left < width_; left += kSide) {
            if (!has_tile(left / kSide, top / kSide)) continue;
            for (uint32_t y = 0; y < std::min(kSide, height_ - top); ++y)
                for (uint32_t x = 0; x < std::min(kSide, width_ - left); ++x) {
                    const uint8_t* from = image.at(left + x, top + y);
                    if (from[3] > 0) std::copy_n(from, 4, to + size_t{4} * (y * kSide + x));
                }
            to += kTileBytes;
        }
}

void TiledImage::find_tiles(const media::Image& image) {
    groups_.assign(group_count(width_, height_), {});
    for (uint32_t y = 0; y < height_; ++y)
        for (uint32_t x = 0; x < width_; ++x) {
            if (image.at(x, y)[3] == 0) continue;
            const size_t tile = size_t{y / kSide} * tiles_across() + x / kSide;
            groups_[tile / 64].kept |= uint64_t{1} << tile % 64;
        }
    uint64_t before = 0;
    for (Group& group : groups_) {
        group.before = before;
        before += static_cast<uint64_t>(std::popcount(group.kept));
    }
}

media::Image TiledImage::whole() const {
    media::Image image(width_, height_);
    for_each_kept([&](uint32_t x, uint32_t y, const uint8_t* rgba) { std::copy_n(rgba, 4, image.at(x, y)); });
    return image;
}

uint64_t TiledImage::max_bytes(uint32_t width, uint32_t height) {
    return group_count(width, height) * sizeof(Group) + uint64_t{tiles_along(width)} * tiles_along(height) * kTileBytes;
}

}  // namespace neuvv::training
