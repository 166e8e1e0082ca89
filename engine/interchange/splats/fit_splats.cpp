#include "interchange/splats/fit_splats.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace neuvv::interchange {

namespace {

constexpr double kPixelsOfLeaf = 4;

}  // namespace

std::vector<slice::Leaf> typical_leaves(const slice::Slice& volume, size_t count) {
    assert(!volume.leaves.empty());
    double all = 0, before = 0;
    for (const slice::Leaf& leaf : volume.leaves) all += double{leaf.shown};
    std::vector<slice::Leaf> typical;
    for (const slice::Leaf& leaf : volume.leaves) {
        before += double{leaf.shown};
        while (typical.size() < count &&
               before >= all * (static_cast<double>(typical.size()) + 0.5) / static_cast<double>(count))
            typical.push_back(leaf);
    }
    return typical;
}

stage::Camera close_up(const stage::Camera& camera, const slice::Slice& volume, const slice::Leaf& leaf) {
    const glm::dvec3 at(glm::inverse(camera.world_from_camera) * glm::dvec4(volume.centre_m(leaf), 1));
    assert(at.z < 0);
    stage::Camera close = camera;
    const double factor = std::max(1.0, kPixelsOfLeaf * -at.z / (camera.fx * double{volume.edge_m(leaf)}));
    close.fx *= factor;
    close.fy *= factor;
    close.cx = 0.5 * close.width + close.fx * at.x / at.z;
    close.cy = 0.5 * close.height - close.fy * at.y / at.z;
    return close;
}

double psnr_of(const Splats& splats, std::span<const FitView> views) {
    double sum = 0, count = 0;
    for (const FitView& view : views) {
        const media::Image drawn = splat_image(splats, view.camera, glm::vec3(1));
        for (size_t i = 0; i < drawn.rgba.size(); ++i) {
            if (i % 4 == 3) continue;
            const double difference = (drawn.rgba[i] - view.image.rgba[i]) / 255.0;
            sum += difference * difference;
            ++count;
        }
    }
    return sum > 0 ? std::min(99.0, -10 * std::log10(sum / count)) : 99;
}

SplatFit fit_shape(const slice::Slice& volume, std::span<const FitView> views, const std::function<void()>& between) {
    Splats splats = splats_of(volume, {});
    SplatFit best{{}, psnr_of(splats, views)};
    const auto improves = [&](const SplatShape& shape) {
        between();
        reshape(splats, volume, shape);
        const double psnr = psnr_of(splats, views);
        if (psnr <= best.psnr) return false;
        best = {shape, psnr};
        return true;
    };
    for (const double factor : {1.3, 1.14, 1.06}) {
        for (bool found = true; found;) {
            found = false;
            for (const double change : {factor, 1 / factor}) {
                const SplatShape from = best.shape;
                found |= improves({from.width * change, from.density});
                found |= improves({best.shape.width, best.shape.density * change});
                found |= improves({best.shape.width * change, best.shape.density / (change * change)});  // as opaque
            }
        }
    }
    return best;
}

}  // namespace neuvv::interchange
