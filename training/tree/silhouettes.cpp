#include "training/tree/silhouettes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/threads/parallel.h"

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
        for (uint32_t y = 0; y < height; ++y)
            for (uint32_t x = 0; x < width; ++x)
                if (view.ignores(x, y)) add(x, y);
    });
    return silhouette;
}

// The pixels in which matter in a cell may be visible.
struct Seen {
    PixelRectangle part;  // of the image; empty where there are none, or the cell is too near
    bool whole;           // matter in the cell cannot be visible beyond the image

    bool is_empty() const { return part.x0 >= part.x1 || part.y0 >= part.y1; }
};

// The first whole number that is not below `value`, which is not negative; std::ceil takes longer.
uint32_t ceiled(double value) {
    const auto whole = static_cast<uint32_t>(value);
    return whole + (whole < value ? 1u : 0u);
}

// Of the cell's ball. Carving spends its time here, so there is one division and no branch.
Seen seen_of(const Silhouette& silhouette, const HullCell& cell) {
    const stage::Camera& camera = *silhouette.camera;
    const glm::dvec4 p = silhouette.camera_from_world * glm::dvec4(glm::dvec3(cell.centre), 1);
    const double depth = -p.z, radius = static_cast<double>(cell.radius), nearest = depth - radius;
    const double scale = 1 / (depth * nearest), to_pixels = nearest * scale;
    const double width = camera.width, height = camera.height, is_far = depth > 2 * radius ? 1 : 0;
    const double x = camera.cx + camera.fx * p.x * to_pixels - 0.5, y = camera.cy - camera.fy * p.y * to_pixels - 0.5;
    // The ball's image lies inside this rectangle, whose size is that at the distance of the ball's nearest point.
    // Matter in the ball is visible in pixels whose centres are at most half a pixel further out.
    const double half_width = camera.fx * radius * (depth + std::abs(p.x)) * scale + 0.5;
    const double half_height = camera.fy * radius * (depth + std::abs(p.y)) * scale + 0.5;
    const double left = x - half_width, right = x + half_width, top = y - half_height, bottom = y + half_height;
    // std::min and std::max take their first argument where the second is no number, as it is for a ball at the camera.
    return {{ceiled(std::min(width, std::max(0.0, left))), ceiled(std::min(height, std::max(0.0, top))),
             static_cast<uint32_t>(is_far * std::min(width, std::max(0.0, right + 1))),
             static_cast<uint32_t>(is_far * std::min(height, std::max(0.0, bottom + 1)))},
            left > -1 && right < width && top > -1 && bottom < height};
}

Verdict verdict_of(const Silhouette& silhouette, const Seen& seen) {
    if (seen.is_empty()) return Verdict::kUnseen;
    if (silhouette.foreground.count(seen.part) > 0) return seen.whole ? Verdict::kMatter : Verdict::kMatterInPart;
    return !seen.whole || silhouette.ignored.count(seen.part) > 0 ? Verdict::kUnseen : Verdict::kBackground;
}

}  // namespace

std::vector<Silhouette> silhouettes_at(const Dataset& dataset, double time) {
    std::vector<uint32_t> views;
    for (uint32_t i = 0; i < dataset.views.size(); ++i)
        if (dataset.views[i].time == time) views.push_back(i);
    std::vector<Silhouette> silhouettes(views.size());
    parallel_for(views.size(), 1, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) silhouettes[i] = make_silhouette(dataset, views[i]);
    });
    return silhouettes;
}

std::optional<PixelRectangle> image_of(const Silhouette& silhouette, const HullCell& cell) {
    const Seen seen = seen_of(silhouette, cell);
    return seen.whole && !seen.is_empty() ? std::optional(seen.part) : std::nullopt;
}

PixelRectangle part_in_image(const Silhouette& silhouette, const HullCell& cell) {
    const Seen seen = seen_of(silhouette, cell);
    return seen.is_empty() ? PixelRectangle{0, 0, 0, 0} : seen.part;
}

std::vector<bool> covered_pixels(const Silhouette& silhouette, const std::vector<HullCell>& cells) {
    const uint32_t width = silhouette.camera->width, height = silhouette.camera->height;
    const size_t stride = size_t{width} + 1;
    // Each rectangle adds 1 to its pixels, as differences to the pixel on the left and to the row above.
    std::vector<int32_t> differences(stride * (size_t{height} + 1));
    for (const HullCell& cell : cells) {
        const Seen seen = seen_of(silhouette, cell);
        if (seen.is_empty()) continue;
        const PixelRectangle& r = seen.part;
        ++differences[r.y0 * stride + r.x0];
        --differences[r.y0 * stride + r.x1];
        --differences[r.y1 * stride + r.x0];
        ++differences[r.y1 * stride + r.x1];
    }
    std::vector<bool> covered(size_t{width} * height);
    std::vector<int32_t> counts(width);
    for (uint32_t y = 0; y < height; ++y) {
        int32_t row = 0;
        for (uint32_t x = 0; x < width; ++x) {
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
        for (size_t i = begin; i < end; ++i) {
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
    return verdict_of(silhouette, seen_of(silhouette, cell));
}

std::vector<Witnesses> count_witnesses(const std::vector<Silhouette>& silhouettes, std::span<const HullCell> cells) {
    std::vector<Witnesses> witnesses(cells.size());
    std::vector<uint32_t> possible(cells.size());  // the cells that no image has shown to be empty
    std::iota(possible.begin(), possible.end(), 0u);
    std::vector<Seen> seen(cells.size());
    for (const Silhouette& silhouette : silhouettes) {
        // First the pixels of all cells: they do not wait for what is read of the image, so that a processor computes
        // those of several cells at a time.
        for (size_t k = 0; k < possible.size(); ++k) seen[k] = seen_of(silhouette, cells[possible[k]]);
        size_t left = 0;
        for (size_t k = 0; k < possible.size(); ++k) {
            const uint32_t i = possible[k];
            const Verdict verdict = verdict_of(silhouette, seen[k]);
            if (verdict == Verdict::kMatter) ++witnesses[i].whole;
            if (verdict == Verdict::kMatter || verdict == Verdict::kMatterInPart) ++witnesses[i].all;
            if (verdict == Verdict::kBackground) witnesses[i] = {};
            possible[left] = i;
            left += verdict == Verdict::kBackground ? 0 : 1;
        }
        possible.resize(left);
    }
    return witnesses;
}

}  // namespace neuvv::training
