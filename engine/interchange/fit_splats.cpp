#include "interchange/fit_splats.h"

#include <algorithm>
#include <cmath>

namespace neuvv::interchange {

double psnr_of(const Splats& splats, std::span<const FitView> views) {
    double sum = 0, count = 0;
    for (const FitView& view : views) {
        const media::Image drawn = splat_image(splats, view.camera, glm::vec3(1));
        for (size_t i = 0; i < drawn.rgba.size(); i++) {
            if (i % 4 == 3) continue;
            const double difference = (drawn.rgba[i] - view.image.rgba[i]) / 255.0;
            sum += difference * difference;
            count++;
        }
    }
    return sum > 0 ? std::min(99.0, -10 * std::log10(sum / count)) : 99;
}

SplatFit fit_shape(const FrameVolume& volume, std::span<const FitView> views, const std::function<void()>& between) {
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
            }
        }
    }
    return best;
}

}  // namespace neuvv::interchange
