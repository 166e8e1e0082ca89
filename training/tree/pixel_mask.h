// A set of pixels of an image, and what makes one of another.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "training/tree/silhouettes.h"

namespace neuvv::training {

struct PixelMask {
    uint32_t width = 0, height = 0;
    std::vector<uint8_t> set;  // row by row; 1 where the pixel is in the set

    PixelMask() = default;
    PixelMask(uint32_t w, uint32_t h) : width(w), height(h), set(size_t{w} * h) {}
    size_t size() const { return set.size(); }
    bool operator[](size_t pixel) const { return set[pixel] != 0; }
};

// Calls visit(pixel) for each pixel that touches this one, corners included or not.
template <typename Visit>
void for_each_neighbour(const PixelMask& mask, size_t pixel, bool corners, const Visit& visit) {
    const auto x = static_cast<int64_t>(pixel % mask.width), y = static_cast<int64_t>(pixel / mask.width);
    for (int64_t v = -1; v <= 1; ++v)
        for (int64_t u = -1; u <= 1; ++u) {
            if ((u == 0 && v == 0) || (!corners && u != 0 && v != 0)) continue;
            if (x + u < 0 || y + v < 0 || x + u >= mask.width || y + v >= mask.height) continue;
            visit(static_cast<size_t>((y + v) * mask.width + x + u));
        }
}

PixelSums sums_of(const PixelMask& mask);

PixelMask inverse(PixelMask mask);
// With all pixels at most `radius` beside or above one of the mask, along either side.
PixelMask grown(const PixelMask& mask, uint32_t radius);
// Without the pixels that are so near to one that is not in the mask. Beyond the image, all are in it.
PixelMask shrunk(const PixelMask& mask, uint32_t radius);
// Grown, then shrunk: gaps of up to 2·radius pixels are closed.
PixelMask closed(const PixelMask& mask, uint32_t radius);

// Calls `visit` with the pixels of each part of the mask whose pixels touch, corners included.
void for_each_part(const PixelMask& mask, const std::function<void(const std::vector<size_t>& part)>& visit);

// Without the parts of at most `speck` pixels.
PixelMask without_specks(const PixelMask& mask, size_t speck);

// The convex hulls of the mask's parts, where those that are at most 2·`reach` pixels apart are one part. Parts of at
// most `speck` pixels are left out.
PixelMask convex_parts(const PixelMask& mask, uint32_t reach, size_t speck);

// All pixels that cannot be reached from a pixel outside `limit`, by steps along either side, without entering `walls`.
PixelMask enclosed(const PixelMask& walls, const PixelMask& limit);

}  // namespace neuvv::training
