#include "reference/paint.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace neuvv::reference {
namespace {

const double kY00 = 0.5 / std::sqrt(std::numbers::pi);

double luminance(glm::dvec3 c) {
    return 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b;
}

// The colour scaled to a luminance; its saturation is reduced where a channel would exceed 1.
glm::dvec3 with_luminance(glm::dvec3 colour, double target) {
    if (luminance(colour) < 1e-6) return glm::dvec3(target);
    const glm::dvec3 scaled = colour * (target / luminance(colour));
    double saturation = 1;
    for (int c = 0; c < 3; ++c)
        if (scaled[c] > 1) saturation = std::min(saturation, (1 - target) / (scaled[c] - target));
    return glm::dvec3(target) + saturation * (scaled - target);
}

void paint_leaf(LeafSlice& leaf, uint32_t degree, const PaintStep& step, const voctree::LeafEdit& edit) {
    if (edit.sigma >= 0) leaf.sigma += step.opacity * (double{edit.sigma} - leaf.sigma);
    const double part = step.opacity * double{edit.alpha};
    if (part == 0) return;
    glm::dvec3 mean;
    for (int c = 0; c < 3; ++c) mean[c] = 1 / (1 + std::exp(-kY00 * leaf.k[static_cast<size_t>(c)][0]));
    mean += part * (blend(step.blend, mean, glm::dvec3(edit.colour)) - mean);
    for (int c = 0; c < 3; ++c) {
        const double clamped = std::clamp(mean[c], double{kPaintBlack}, 1 - double{kPaintBlack});
        leaf.k[static_cast<size_t>(c)][0] = std::log(clamped / (1 - clamped)) / kY00;
    }
    for (size_t j = 1; j < sh_count(degree); ++j) {
        const double grey = luminance({leaf.k[0][j], leaf.k[1][j], leaf.k[2][j]});
        for (auto& channel : leaf.k) {
            if (step.blend == kPaintNormal) channel[j] *= 1 - part;
            if (step.blend == kPaintTint || step.blend == kPaintRecolour) channel[j] += part * (grey - channel[j]);
        }
    }
}

}  // namespace

glm::dvec3 blend(uint32_t mode, glm::dvec3 colour, glm::dvec3 target) {
    if (mode == kPaintMultiply) return colour * target;
    if (mode == kPaintTint) return with_luminance(colour * target, luminance(colour));
    if (mode == kPaintRecolour) return with_luminance(target, luminance(colour));
    return target;
}

void paint(std::vector<LeafSlice>& slices, uint32_t degree, const std::vector<PaintStep>& steps, double frame) {
    for (const PaintStep& step : steps)
        for (const voctree::LeafEdit& edit : step.layer->edits)
            if (double{edit.first} <= frame && frame <= double{edit.last})
                paint_leaf(slices[edit.leaf], degree, step, edit);
}

}  // namespace neuvv::reference
