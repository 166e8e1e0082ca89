#include "voctree/slice_paint.h"

#include <algorithm>
#include <cmath>

#include "base/sigmoid.h"

namespace neuvv::voctree {

namespace {

constexpr float kLeastLuminance = 1e-6f;

float luminance(glm::vec3 c) {
    return 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b;
}

// The colour scaled to a luminance (0 to 1); its saturation is reduced where a channel would exceed 1.
glm::vec3 with_luminance(glm::vec3 colour, float target) {
    const float current = luminance(colour);
    if (current < kLeastLuminance) return glm::vec3(target);
    const glm::vec3 scaled = colour * (target / current);
    const float largest = std::max({scaled.r, scaled.g, scaled.b});
    return largest > 1 ? target + (scaled - target) * ((1 - target) / (largest - target)) : scaled;
}

// The result of a layer over a colour where its weight is 1.
glm::vec3 blended(uint32_t blend, glm::vec3 colour, glm::vec3 target) {
    switch (blend) {
        case kPaintMultiply:
            return colour * target;
        case kPaintTint:
            return with_luminance(colour * target, luminance(colour));
        case kPaintRecolour:
            return with_luminance(target, luminance(colour));
        default:
            return target;
    }
}

glm::vec3 mean_colour(const slice::Colours& k) {
    glm::vec3 mean;
    for (int c = 0; c < 3; ++c) mean[c] = sigmoid(slice::kMeanHarmonic * k[static_cast<size_t>(c)][0]);
    return mean;
}

void set_mean_colour(glm::vec3 mean, slice::Colours& k) {
    for (int c = 0; c < 3; ++c) k[static_cast<size_t>(c)][0] = std::log(mean[c] / (1 - mean[c])) / slice::kMeanHarmonic;
}

// What a layer of weight `part` leaves of the coefficients that let the colour depend on the direction of view.
void paint_harmonics(uint32_t blend, float part, uint32_t degree, slice::Colours& k) {
    for (size_t i = 1; i < sh_count(degree); ++i) {
        const float grey = luminance({k[0][i], k[1][i], k[2][i]});
        for (auto& channel : k) {
            if (blend == kPaintNormal) channel[i] *= 1 - part;
            if (blend == kPaintTint || blend == kPaintRecolour) channel[i] += part * (grey - channel[i]);
        }
    }
}

}  // namespace

FrameEdits::FrameEdits(std::span<const PaintStep> steps, float frame) {
    for (const PaintStep& step : steps)
        for (const LeafEdit& edit : step.layer->edits)
            if (edit.first <= frame && frame <= edit.last)
                applied_.push_back({edit.leaf, step.blend, step.opacity, &edit});
    std::ranges::stable_sort(applied_, {}, &Applied::leaf);
}

std::span<const FrameEdits::Applied> FrameEdits::of_leaf(uint32_t leaf) const {
    return {std::ranges::lower_bound(applied_, leaf, {}, &Applied::leaf),
            std::ranges::upper_bound(applied_, leaf, {}, &Applied::leaf)};
}

float FrameEdits::painted_density(uint32_t leaf, float sigma) const {
    for (const Applied& one : of_leaf(leaf))
        if (one.edit->sigma >= 0) sigma += one.opacity * (one.edit->sigma - sigma);
    return sigma;
}

void FrameEdits::paint_colours(uint32_t leaf, uint32_t degree, slice::Colours& k) const {
    for (const Applied& one : of_leaf(leaf)) {
        const float part = one.opacity * one.edit->alpha;
        if (part == 0) continue;
        const glm::vec3 mean = mean_colour(k);
        const glm::vec3 painted = glm::mix(mean, blended(one.blend, mean, one.edit->colour), part);
        set_mean_colour(glm::clamp(painted, kPaintBlack, 1 - kPaintBlack), k);
        paint_harmonics(one.blend, part, degree, k);
    }
}

}  // namespace neuvv::voctree
