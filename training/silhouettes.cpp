#include "training/silhouettes.h"

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
    const stage::Camera& camera = *silhouette.camera;
    const glm::dvec4 p = silhouette.camera_from_world * glm::dvec4(glm::dvec3(cell.centre), 1);
    const double depth = -p.z, radius = static_cast<double>(cell.radius);
    if (depth <= 2 * radius) return {};
    const double x = camera.cx + camera.fx * p.x / depth, y = camera.cy - camera.fy * p.y / depth;
    // The ball's image lies inside this rectangle, whose size is that at the distance of the ball's nearest point.
    // Matter in the ball is visible in pixels whose centres are at most half a pixel further out.
    const double half_width = camera.fx * radius * (1 + std::abs(p.x) / depth) / (depth - radius) + 0.5;
    const double half_height = camera.fy * radius * (1 + std::abs(p.y) / depth) / (depth - radius) + 0.5;
    const double left = std::ceil(x - half_width - 0.5), right = std::floor(x + half_width - 0.5) + 1;
    const double top = std::ceil(y - half_height - 0.5), bottom = std::floor(y + half_height - 0.5) + 1;
    if (!(left >= 0 && top >= 0 && right <= camera.width && bottom <= camera.height)) return {};
    return PixelRectangle{static_cast<uint32_t>(left), static_cast<uint32_t>(top), static_cast<uint32_t>(right),
                          static_cast<uint32_t>(bottom)};
}

Verdict judge(const Silhouette& silhouette, const HullCell& cell) {
    const std::optional<PixelRectangle> image = image_of(silhouette, cell);
    if (!image) return Verdict::kUnseen;
    if (silhouette.foreground.count(*image) > 0) return Verdict::kMatter;
    return silhouette.ignored.count(*image) > 0 ? Verdict::kUnseen : Verdict::kBackground;
}

}  // namespace neuvv::training
