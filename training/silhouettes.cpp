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
    silhouette.foreground =
        PixelSums(width, height, [&](uint32_t x, uint32_t y) { return view.image.at(x, y)[3] >= kMatteThreshold; });
    if (!view.ignored.empty())
        silhouette.ignored = PixelSums(width, height, [&](uint32_t x, uint32_t y) { return view.ignores(x, y); });
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

Verdict judge(const Silhouette& silhouette, const HullCell& cell) {
    const std::optional<PixelRectangle> image = image_of(silhouette, cell);
    if (!image) return Verdict::kUnseen;
    if (silhouette.foreground.count(*image) > 0) return Verdict::kMatter;
    return silhouette.ignored.count(*image) > 0 ? Verdict::kUnseen : Verdict::kBackground;
}

}  // namespace neuvv::training
