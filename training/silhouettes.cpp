#include "training/silhouettes.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"

namespace neuvv::training {

namespace {

Silhouette make_silhouette(const Dataset& dataset, uint32_t index) {
    const View& view = dataset.views[index];
    Silhouette silhouette;
    silhouette.view = index;
    silhouette.camera = &dataset.cameras[view.camera];
    silhouette.camera_from_world = glm::inverse(silhouette.camera->world_from_camera);
    const uint32_t width = silhouette.camera->width, height = silhouette.camera->height;
    silhouette.foreground = PixelSums(width, height, [&](const auto& add) {
        view.image.for_each_kept([&](uint32_t x, uint32_t y, const uint8_t* rgba) {
            if (rgba[3] >= kMatteThreshold) add(x, y);
        });
    });
    if (view.ignored.empty()) return silhouette;
    silhouette.ignored = PixelSums(width, height, [&](const auto& add) {
        for (uint32_t y = 0; y < height; y++)
            for (uint32_t x = 0; x < width; x++)
                if (view.ignores(x, y)) add(x, y);
    });
    return silhouette;
}

// A rectangle that may reach beyond the image, in pixels.
struct Extent {
    double left, top, right, bottom;
};

// The pixels in which matter in the cell's ball may be visible; nothing where the ball is too near.
std::optional<Extent> extent_of(const Silhouette& silhouette, const HullCell& cell) {
    const stage::Camera& camera = *silhouette.camera;
    const glm::dvec4 p = silhouette.camera_from_world * glm::dvec4(glm::dvec3(cell.centre), 1);
    const double depth = -p.z, radius = static_cast<double>(cell.radius);
    if (depth <= 2 * radius) return {};
    const double x = camera.cx + camera.fx * p.x / depth, y = camera.cy - camera.fy * p.y / depth;
    // The ball's image lies inside this rectangle, whose size is that at the distance of the ball's nearest point.
    // Matter in the ball is visible in pixels whose centres are at most half a pixel further out.
    const double half_width = camera.fx * radius * (1 + std::abs(p.x) / depth) / (depth - radius) + 0.5;
    const double half_height = camera.fy * radius * (1 + std::abs(p.y) / depth) / (depth - radius) + 0.5;
    return Extent{std::ceil(x - half_width - 0.5), std::ceil(y - half_height - 0.5),
                  std::floor(x + half_width - 0.5) + 1, std::floor(y + half_height - 0.5) + 1};
}

PixelRectangle rectangle_of(const Extent& extent) {
    return {static_cast<uint32_t>(extent.left), static_cast<uint32_t>(extent.top), static_cast<uint32_t>(extent.right),
            static_cast<uint32_t>(extent.bottom)};
}

}  // namespace

std::vector<Silhouette> silhouettes_at(const Dataset& dataset, double time) {
    std::vector<uint32_t> views;
    for (uint32_t i = 0; i < dataset.views.size(); i++)
        if (dataset.views[i].time == time) views.push_back(i);
    std::vector<Silhouette> silhouettes(views.size());
    parallel_for(views.size(), 1, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; i++) silhouettes[i] = make_silhouette(dataset, views[i]);
    });
    return silhouettes;
}

std::optional<PixelRectangle> image_of(const Silhouette& silhouette, const HullCell& cell) {
    const std::optional<Extent> whole = extent_of(silhouette, cell);
    if (!whole || !(whole->left >= 0 && whole->top >= 0 && whole->right <= silhouette.camera->width &&
                    whole->bottom <= silhouette.camera->height))
        return {};
    return rectangle_of(*whole);
}

std::optional<PixelRectangle> visible_part_of(const Silhouette& silhouette, const HullCell& cell) {
    const std::optional<Extent> whole = extent_of(silhouette, cell);
    if (!whole) return {};
    const double width = silhouette.camera->width, height = silhouette.camera->height;
    const Extent part{std::max(whole->left, 0.0), std::max(whole->top, 0.0), std::min(whole->right, width),
                      std::min(whole->bottom, height)};
    if (!(part.left < part.right && part.top < part.bottom)) return {};
    return rectangle_of(part);
}

std::vector<bool> covered_pixels(const Silhouette& silhouette, const std::vector<HullCell>& cells) {
    const uint32_t width = silhouette.camera->width, height = silhouette.camera->height;
    const size_t stride = size_t{width} + 1;
    // Each rectangle adds 1 to its pixels, as differences to the pixel on the left and to the row above.
    std::vector<int32_t> differences(stride * (size_t{height} + 1));
    for (const HullCell& cell : cells) {
        const std::optional<PixelRectangle> r = visible_part_of(silhouette, cell);
        if (!r) continue;
        differences[r->y0 * stride + r->x0]++;
        differences[r->y0 * stride + r->x1]--;
        differences[r->y1 * stride + r->x0]--;
        differences[r->y1 * stride + r->x1]++;
    }
    std::vector<bool> covered(size_t{width} * height);
    std::vector<int32_t> counts(width);
    for (uint32_t y = 0; y < height; y++) {
        int32_t row = 0;
        for (uint32_t x = 0; x < width; x++) {
            row += differences[y * stride + x];
            counts[x] += row;
            covered[size_t{y} * width + x] = counts[x] > 0;
        }
    }
    return covered;
}

std::vector<PixelSums> unexplained_pixels(const Dataset& dataset, const std::vector<Silhouette>& silhouettes,
                                          const std::vector<HullCell>& cells) {
    std::vector<PixelSums> unexplained(silhouettes.size());
    parallel_for(silhouettes.size(), 1, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; i++) {
            const std::vector<bool> covered = covered_pixels(silhouettes[i], cells);
            const TiledImage& image = dataset.views[silhouettes[i].view].image;
            unexplained[i] = PixelSums(image.width(), image.height(), [&](const auto& add) {
                image.for_each_kept([&](uint32_t x, uint32_t y, const uint8_t* rgba) {
                    if (rgba[3] >= kMatteThreshold && !covered[size_t{y} * image.width() + x]) add(x, y);
                });
            });
        }
    });
    return unexplained;
}

Verdict judge(const Silhouette& silhouette, const HullCell& cell) {
    const std::optional<PixelRectangle> seen = visible_part_of(silhouette, cell);
    if (!seen) return Verdict::kUnseen;
    const bool whole = image_of(silhouette, cell).has_value();
    if (silhouette.foreground.count(*seen) > 0) return whole ? Verdict::kMatter : Verdict::kMatterInPart;
    return !whole || silhouette.ignored.count(*seen) > 0 ? Verdict::kUnseen : Verdict::kBackground;
}

Witnesses count_witnesses(const std::vector<Silhouette>& silhouettes, const HullCell& cell) {
    Witnesses witnesses;
    for (const Silhouette& silhouette : silhouettes) {
        const Verdict verdict = judge(silhouette, cell);
        if (verdict == Verdict::kBackground) return {};
        if (verdict == Verdict::kMatter) witnesses.whole++;
        if (verdict != Verdict::kUnseen) witnesses.all++;
    }
    return witnesses;
}

}  // namespace neuvv::training
