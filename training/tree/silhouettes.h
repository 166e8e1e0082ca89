// What the matte of an image says about a cell of space.
#pragma once

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include "training/data/dataset.h"
#include "training/tree/hull.h"

namespace neuvv::training {

// The lowest alpha that counts as foreground in carving.
constexpr uint8_t kMatteThreshold = 32;

struct PixelRectangle {
    uint32_t x0, y0, x1, y1;  // x1 and y1 lie beyond the last pixel
};

// How many pixels of a kind lie above and to the left of each corner of pixels: the count in any rectangle takes four
// reads.
struct PixelSums {
    size_t stride = 0;
    std::vector<uint32_t> sums;  // (width+1) × (height+1); empty: no pixel is of the kind

    // visit(add) calls add(x, y) for each pixel of the kind, once.
    template <typename Visit>
    PixelSums(uint32_t width, uint32_t height, const Visit& visit) : stride(size_t{width} + 1) {
        sums.resize(stride * (size_t{height} + 1));
        visit([this](uint32_t x, uint32_t y) { sums[(y + size_t{1}) * stride + x + 1] = 1; });
        for (uint32_t y = 1; y <= height; ++y) {
            uint32_t row = 0;
            for (uint32_t x = 1; x <= width; ++x) {
                row += sums[y * stride + x];
                sums[y * stride + x] = sums[(y - 1) * stride + x] + row;
            }
        }
        if (sums.back() == 0) sums = {};
    }
    PixelSums() = default;

    uint32_t count(const PixelRectangle& r) const {
        if (sums.empty()) return 0;
        return sums[r.y1 * stride + r.x1] - sums[r.y0 * stride + r.x1] - sums[r.y1 * stride + r.x0] +
               sums[r.y0 * stride + r.x0];
    }
};

struct Silhouette {
    uint32_t view = 0;  // index into Dataset::views
    glm::dmat4 camera_from_world{1};
    const stage::Camera* camera = nullptr;
    PixelSums foreground, ignored;
};

// Those of all images of a time.
std::vector<Silhouette> silhouettes_at(const Dataset& dataset, double time);

// The pixels in which matter in the cell's ball may be visible; nothing where the ball is too near, or partly outside
// the image.
std::optional<PixelRectangle> image_of(const Silhouette& silhouette, const HullCell& cell);

// The pixels in which matter in the cell's ball may be visible, if only a part of the ball is in the image, too; empty
// where there are none, and where the ball is too near.
PixelRectangle part_in_image(const Silhouette& silhouette, const HullCell& cell);

// For each pixel of the image, row by row, whether one of the cells may be visible in it.
std::vector<bool> covered_pixels(const Silhouette& silhouette, const std::vector<HullCell>& cells);

// By image the foreground pixels in which none of the cells may be visible.
std::vector<PixelSums> unexplained_pixels(const Dataset& dataset, const std::vector<Silhouette>& silhouettes,
                                          const std::vector<HullCell>& cells);

// What an image shows of a cell. kUnseen: nothing can be said. kMatterInPart: the cell is partly outside the image, and
// matter is seen in what is inside.
enum class Verdict { kUnseen, kBackground, kMatterInPart, kMatter };

Verdict judge(const Silhouette& silhouette, const HullCell& cell);

// The images that show matter in a cell, and those of them that show the whole cell. Both are 0 where an image shows
// only background there.
struct Witnesses {
    uint16_t all = 0, whole = 0;
};
// Of each cell.
std::vector<Witnesses> count_witnesses(const std::vector<Silhouette>& silhouettes, std::span<const HullCell> cells);

// The witnesses that a cell of the hull needs: two, or one where a time has a single image.
inline size_t min_witnesses(const std::vector<Silhouette>& silhouettes) {
    return std::clamp<size_t>(silhouettes.size(), 1, 2);
}

}  // namespace neuvv::training
